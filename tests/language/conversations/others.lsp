{"jsonrpc": "2.0", "method": "workspace/didChangeConfiguration", "params": {"settings": {"flank": {"inlayHints": {"literals": true}}}}}
{"jsonrpc": "2.0", "method": "flank/didFocus", "params": {"textDocument": {"uri": "file:///nowhere/fuzzed.chain"}}}
{"jsonrpc": "2.0", "id": "solve", "method": "workspace/executeCommand", "params": {"command": "flank.solve", "arguments": ["file:///nowhere/fuzzed.chain", "thread"]}}
{"jsonrpc": "2.0", "id": "why", "method": "workspace/executeCommand", "params": {"command": "flank.explain", "arguments": ["E0201"]}}
{"jsonrpc": "2.0", "id": "text", "method": "workspace/textDocumentContent", "params": {"uri": "flank-library:/machines/cradle.chain"}}
{"jsonrpc": "2.0", "method": "textDocument/didOpen", "params": {"textDocument": {"uri": "untitled:one", "languageId": "chain", "version": 1, "text": "use \"fuzzed.chain\"\n"}}}
{"jsonrpc": "2.0", "id": 99, "method": "textDocument/nonsense", "params": []}
{nop}
\Content-Length: 3
\
\[1]Content-Length: twelve
\no header at all
{"jsonrpc": "2.0", "id": 100, "method": "shutdown"}
{"jsonrpc": "2.0", "method": "exit", "params": null}
