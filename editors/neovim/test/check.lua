-- Opens a wrong spec without a screen: it is diagnosed, mended, laid out, and a name leads to its definition.

local function fail(message)
  io.stderr:write('FAILED: ' .. message .. '\n')
  vim.cmd('cquit 1')
end

local function expect(found, wanted, what)
  if not vim.deep_equal(found, wanted) then
    fail(what .. ': ' .. vim.inspect(found) .. ' instead of ' .. vim.inspect(wanted))
  end
end

local function wait(what, condition)
  if not vim.wait(5000, condition, 10) then
    fail('no ' .. what .. ' within 5 s')
  end
end

vim.cmd('edit ' .. vim.env.SPEC)
expect(vim.bo.filetype, 'chain', 'the kind of file')
wait('finding', function() return #vim.diagnostic.get(0) > 0 end)
local found = vim.diagnostic.get(0)[1]
expect({ found.lnum, found.col, found.end_col, found.code }, { 5, 18, 21, 'E0201' }, 'the finding')

-- the unsaved text counts
vim.api.nvim_buf_set_text(0, 5, 18, 5, 21, { 'bed' })
wait('mended text', function() return #vim.diagnostic.get(0) == 0 end)

-- laid out
vim.lsp.buf.formatting_sync({}, 5000)
expect(vim.api.nvim_buf_get_lines(0, 1, 2, false)[1], '    axis C : rotary', 'the layout')

-- from a use to the definition
vim.api.nvim_win_set_cursor(0, { 6, 34 })
local answers = vim.lsp.buf_request_sync(0, 'textDocument/definition', vim.lsp.util.make_position_params(), 5000)
local _, answer = next(answers or {})
expect(answer and answer.result and answer.result.range.start, { line = 1, character = 9 }, 'the definition')

-- the page that follows
vim.cmd('edit! ' .. vim.env.JOB)
wait('server of the job', function() return vim.lsp.buf_get_clients(0) and next(vim.lsp.buf_get_clients(0)) ~= nil end)
local opened
vim.ui.open = function(address) opened = address end
vim.cmd('FlankPreview')
wait('page', function() return opened ~= nil end)
expect(opened:match('^http://127%.0%.0%.1:%d+/') ~= nil, true, 'the address ' .. opened)

-- it hears which spec is in focus
local _, client = next(vim.lsp.buf_get_clients(0))
local told, notify = {}, client.notify
client.notify = function(method, params)
  if method == 'flank/didFocus' then
    table.insert(told, params.textDocument.uri)
  end
  return notify(method, params)
end
vim.cmd('edit! ' .. vim.env.SPEC)
expect(told, { vim.uri_from_fname(vim.env.SPEC) }, 'the spec in focus')

print('Neovim ' .. tostring(vim.version().minor) .. ': diagnosed, mended, laid out, defined, shown\n')
vim.cmd('qall!')
