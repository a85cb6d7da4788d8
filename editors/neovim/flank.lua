-- flank in Neovim: copy this file to ~/.config/nvim/plugin/flank.lua
-- Neovim 0.11 has its own way to name servers; older ones, from 0.7 on, start one for each folder.
-- Colours come from the parser of docs/editors.md, where that is built.

local marks = { 'flank.toml', '.git' }
local command = { vim.env.FLANK or 'flank', 'lsp' }
-- the page is opened here, not by the server
local options = { preview = { opens = true } }

if vim.fn.has('nvim-0.8') == 1 then
  vim.filetype.add({ extension = { chain = 'chain' } })
else
  vim.api.nvim_create_autocmd({ 'BufRead', 'BufNewFile' }, {
    pattern = '*.chain',
    callback = function() vim.bo.filetype = 'chain' end,
  })
end

--- Colours by the parser, if there is one that this Neovim can read.
local function colour(buffer)
  if vim.treesitter.start and #vim.api.nvim_get_runtime_file('parser/chain.*', false) > 0 then
    pcall(vim.treesitter.start, buffer, 'chain')
  end
end

vim.api.nvim_create_autocmd('FileType', {
  pattern = 'chain',
  callback = function(found)
    vim.bo.commentstring = '// %s'
    vim.bo.shiftwidth, vim.bo.tabstop, vim.bo.expandtab = 4, 4, true
    colour(found.buf)
  end,
})

-- what the server says of names has colours, too
if vim.fn.has('nvim-0.9') == 1 then
  local links = {
    machine = '@type', tool = '@type', job = '@type', frame = '@module', axis = '@variable', motion = '@variable',
    value = '@variable', surface = '@variable', profile = '@variable', unit = '@type.builtin', dimension = '@type.builtin',
    status = '@constant',
  }
  for kind, group in pairs(links) do
    vim.api.nvim_set_hl(0, '@lsp.type.' .. kind .. '.chain', { link = group, default = true })
  end
end

--- The server of a buffer.
local function server_of(buffer)
  for _, client in ipairs((vim.lsp.get_clients or vim.lsp.get_active_clients)()) do
    if client.name == 'flank' and vim.lsp.buf_is_attached(buffer, client.id) then
      return client
    end
  end
end

--- Calls a function of a server: since 0.11 they are methods.
local function call(client, name, ...)
  if vim.fn.has('nvim-0.11') == 1 then
    return client[name](client, ...)
  end
  return client[name](...)
end

-- the page shows the spec in focus
vim.api.nvim_create_autocmd('BufEnter', {
  pattern = '*.chain',
  callback = function(found)
    local client = server_of(found.buf)
    if client then
      call(client, 'notify', 'flank/didFocus', { textDocument = { uri = vim.uri_from_bufnr(found.buf) } })
    end
  end,
})

--- Opens the page that follows a spec; says its address where Neovim opens none.
local function preview(arguments)
  local client = server_of(0)
  if not client then
    return
  end
  call(client, 'request', 'workspace/executeCommand', { command = 'flank.preview', arguments = arguments }, function(failure, answer)
    if failure then
      vim.notify(failure.message, vim.log.levels.ERROR)
    elseif vim.ui.open then
      vim.ui.open(answer.url)
    else
      print(answer.url)
    end
  end)
end

vim.lsp.commands['flank.preview'] = function(command) preview(command.arguments) end
vim.api.nvim_create_user_command('FlankPreview', function() preview({ vim.uri_from_bufnr(0) }) end, {})

if vim.lsp.config then
  vim.lsp.config('flank', { cmd = command, init_options = options, filetypes = { 'chain' }, root_markers = marks })
  vim.lsp.enable('flank')
  return
end

local started = {}

--- The folder above a file that holds a mark, or its own.
local function root_of(file)
  local folder = vim.fn.fnamemodify(file, ':p:h')
  local own = folder
  while folder ~= vim.fn.fnamemodify(folder, ':h') do
    for _, mark in ipairs(marks) do
      if vim.loop.fs_stat(folder .. '/' .. mark) then
        return folder
      end
    end
    folder = vim.fn.fnamemodify(folder, ':h')
  end
  return own
end

vim.api.nvim_create_autocmd('FileType', {
  pattern = 'chain',
  callback = function(found)
    local root = root_of(vim.api.nvim_buf_get_name(found.buf))
    local client = started[root]
    if not client or vim.lsp.client_is_stopped(client) then
      client = vim.lsp.start_client({ name = 'flank', cmd = command, init_options = options, root_dir = root })
      started[root] = client
    end
    vim.lsp.buf_attach_client(found.buf, client)
    vim.bo[found.buf].omnifunc = 'v:lua.vim.lsp.omnifunc'
  end,
})
