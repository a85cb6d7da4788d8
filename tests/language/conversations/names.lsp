{"jsonrpc": "2.0", "id": 1, "method": "textDocument/hover", "params": {"textDocument": {"uri": "file:///nowhere/fuzzed.chain"}, "position": {"line": 3, "character": 10}}}
{"jsonrpc": "2.0", "id": 2, "method": "textDocument/definition", "params": {"textDocument": {"uri": "file:///nowhere/fuzzed.chain"}, "position": {"line": 3, "character": 24}}}
{"jsonrpc": "2.0", "id": 3, "method": "textDocument/references", "params": {"textDocument": {"uri": "file:///nowhere/fuzzed.chain"}, "position": {"line": 1, "character": 9}, "context": {"includeDeclaration": true}}}
{"jsonrpc": "2.0", "id": 4, "method": "textDocument/documentSymbol", "params": {"textDocument": {"uri": "file:///nowhere/fuzzed.chain"}}}
{"jsonrpc": "2.0", "id": 5, "method": "textDocument/foldingRange", "params": {"textDocument": {"uri": "file:///nowhere/fuzzed.chain"}}}
{"jsonrpc": "2.0", "id": 6, "method": "textDocument/semanticTokens/full", "params": {"textDocument": {"uri": "file:///nowhere/fuzzed.chain"}}}
{"jsonrpc": "2.0", "id": 7, "method": "textDocument/inlayHint", "params": {"textDocument": {"uri": "file:///nowhere/fuzzed.chain"}, "range": {"start": {"line": 0, "character": 0}, "end": {"line": 9, "character": 0}}}}
{"jsonrpc": "2.0", "id": 8, "method": "textDocument/codeLens", "params": {"textDocument": {"uri": "file:///nowhere/fuzzed.chain"}}}
{"jsonrpc": "2.0", "id": 9, "method": "textDocument/prepareRename", "params": {"textDocument": {"uri": "file:///nowhere/fuzzed.chain"}, "position": {"line": 1, "character": 9}}}
{"jsonrpc": "2.0", "id": 10, "method": "textDocument/rename", "params": {"textDocument": {"uri": "file:///nowhere/fuzzed.chain"}, "position": {"line": 1, "character": 9}, "newName": "B"}}
