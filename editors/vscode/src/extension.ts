// The extension starts `flank lsp` and shows what only an editor can: the page that follows, documents of the library.

import { execFile } from "node:child_process";
import { promisify } from "node:util";
import * as vscode from "vscode";
import { LanguageClient, type ServerOptions } from "vscode-languageclient/node";

const run = promisify(execFile);
/** Documents that the server has and no file holds. */
const SCHEMES = ["flank-library", "flank-error"];

let client: LanguageClient | undefined;
let panel: vscode.WebviewPanel | undefined;
/** The address that the panel frames. */
let framed: string | undefined;

export async function activate(context: vscode.ExtensionContext): Promise<void> {
    for (const scheme of SCHEMES) {
        context.subscriptions.push(vscode.workspace.registerTextDocumentContentProvider(scheme, { provideTextDocumentContent: content }));
    }
    context.subscriptions.push(
        vscode.commands.registerCommand("flank.previewHere", () => preview(vscode.window.activeTextEditor?.document.uri.toString())),
        vscode.commands.registerCommand("flank.restart", async () => {
            await stop();
            await start();
        }),
        vscode.window.onDidChangeActiveTextEditor((editor) => {
            if (panel && editor?.document.languageId === "chain") {
                client?.sendNotification("flank/didFocus", { textDocument: { uri: editor.document.uri.toString() } });
            }
        }),
        vscode.workspace.onDidChangeConfiguration(async (event) => {
            if (event.affectsConfiguration("flank.path")) await vscode.commands.executeCommand("flank.restart");
        }),
    );
    await start();
}

export async function deactivate(): Promise<void> {
    await stop();
}

async function start(): Promise<void> {
    const settings = vscode.workspace.getConfiguration("flank");
    const command = settings.get<string>("path") || "flank";
    try {
        await run(command, ["--version"]);
    } catch {
        const open = "Open the settings";
        const message = `The program \`${command}\` cannot be started. Install it (\`cargo install --path crates/cli\` in flank's repository), or name it in the setting flank.path.`;
        const answer = await vscode.window.showErrorMessage(message, open);
        if (answer === open) await vscode.commands.executeCommand("workbench.action.openSettings", "flank.path");
        return;
    }
    const server: ServerOptions = { command, args: ["lsp"] };
    client = new LanguageClient("flank", "flank", server, {
        documentSelector: [{ language: "chain" }],
        initializationOptions: { inlayHints: settings.get("inlayHints"), preview: { ...settings.get<object>("preview"), opens: true } },
        synchronize: {
            configurationSection: "flank",
            fileEvents: vscode.workspace.createFileSystemWatcher("**/*.{chain,csv}"),
        },
        middleware: {
            provideCompletionItem: async (document, position, context, token, next) => goingOn(await next(document, position, context, token)),
            executeCommand: (name, given, next) => {
                if (name === "flank.preview") return preview(given[0] as string, given[1] as string);
                if (name === "flank.explain") return explain(given[0] as string);
                return next(name, given);
            },
        },
    });
    await client.start();
}

/** Behind a folder of a path its own files are proposed. */
function goingOn(found: vscode.CompletionItem[] | vscode.CompletionList | null | undefined): typeof found {
    const items = Array.isArray(found) ? found : (found?.items ?? []);
    for (const item of items) {
        if (item.kind === vscode.CompletionItemKind.Folder) item.command = { title: "", command: "editor.action.triggerSuggest" };
    }
    return found;
}

async function stop(): Promise<void> {
    panel?.dispose();
    await client?.stop();
    client = undefined;
}

async function content(uri: vscode.Uri): Promise<string> {
    const answer = await client?.sendRequest<{ text: string }>("workspace/textDocumentContent", { uri: uri.toString() });
    return answer?.text ?? "";
}

async function explain(page: string): Promise<void> {
    const document = await vscode.workspace.openTextDocument(vscode.Uri.parse(page));
    await vscode.window.showTextDocument(await vscode.languages.setTextDocumentLanguage(document, "markdown"), { preview: true });
}

/** Frames the page that the server serves, beside the text. */
async function preview(uri: string | undefined, job?: string): Promise<void> {
    if (!uri || !client) return;
    const given = job === undefined ? [uri] : [uri, job];
    const answer = await client.sendRequest<{ url: string }>("workspace/executeCommand", { command: "flank.preview", arguments: given });
    // a port of another machine may be forwarded to some other address; the path behind it stays
    const { origin: there, pathname } = new URL(answer.url);
    const here = (await vscode.env.asExternalUri(vscode.Uri.parse(there))).toString(true);
    frame(here.replace(/\/$/, "") + pathname);
}

/** Shows an address beside the text; a server that was started again has another one. */
function frame(url: string): void {
    if (panel && framed === url) return panel.reveal(undefined, true);
    const place = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
    if (!panel) {
        panel = vscode.window.createWebviewPanel("flank.preview", "flank", place, { enableScripts: true, retainContextWhenHidden: true });
        panel.onDidDispose(() => (panel = framed = undefined));
    }
    framed = url;
    const origin = new URL(url).origin;
    panel.webview.html = `<!DOCTYPE html><html><head><meta http-equiv="Content-Security-Policy" content="default-src 'none'; frame-src ${origin}; style-src 'unsafe-inline'">
<style>html, body, iframe { margin: 0; padding: 0; border: 0; width: 100%; height: 100vh; background: #fff }</style></head>
<body><iframe src="${url}"></iframe></body></html>`;
}
