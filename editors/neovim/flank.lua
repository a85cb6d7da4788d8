-- flank in Neovim: copy this file to ~/.config/nvim/plugin/flank.lua
-- Neovim 0.11 has its own way to name servers; older ones, from 0.7 on, start one for each folder.

local marks = { 'flank.toml', '.git' }
local command = { vim.env.FLANK or 'flank', 'lsp' }

if vim.fn.has('nvim-0.8') == 1 then
  vim.filetype.add({ extension = { chain = 'chain' } })
else
  vim.api.nvim_create_autocmd({ 'BufRead', 'BufNewFile' }, {
    pattern = '*.chain',
    callback = function() vim.bo.filetype = 'chain' end,
  })
end

vim.api.nvim_create_autocmd('FileType', {
  pattern = 'chain',
  callback = function()
    vim.bo.commentstring = '// %s'
    vim.bo.shiftwidth, vim.bo.tabstop, vim.bo.expandtab = 4, 4, true
  end,
})

if vim.lsp.config then
  vim.lsp.config('flank', { cmd = command, filetypes = { 'chain' }, root_markers = marks })
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
      client = vim.lsp.start_client({ name = 'flank', cmd = command, root_dir = root })
      started[root] = client
    end
    vim.lsp.buf_attach_client(found.buf, client)
    vim.bo[found.buf].omnifunc = 'v:lua.vim.lsp.omnifunc'
  end,
})
