/** Starts the language server for XML, OpenSCENARIO and OpenDRIVE files, and shows the pictures that it draws. */

import * as os from "node:os";
import * as vscode from "vscode";
import { LanguageClient, type LanguageClientOptions, type ServerOptions } from "vscode-languageclient/node";

import { launchOf } from "./server";

const NAME = "Scenario compiler";

let client: LanguageClient | undefined;

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  context.subscriptions.push(
    vscode.commands.registerCommand("scenarioCompiler.restart", restart),
    vscode.workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration("scenarioCompiler")) {
        void restart();
      }
    }),
  );
  await start();
}

export async function deactivate(): Promise<void> {
  await client?.dispose();
  client = undefined;
}

async function restart(): Promise<void> {
  await deactivate();
  await start();
}

async function start(): Promise<void> {
  const settings = vscode.workspace.getConfiguration("scenarioCompiler");
  const folders = (vscode.workspace.workspaceFolders ?? []).map((folder) => folder.uri.fsPath);
  const wanted = { command: settings.get<string>("command", ""), maps: settings.get<string[]>("maps", []) };
  const launch = launchOf(wanted, folders, os.homedir());
  const server: ServerOptions = { command: launch.command, args: launch.args };
  const options: LanguageClientOptions = {
    documentSelector: [{ scheme: "file", language: "xml" }],
    middleware: { window: { showDocument } },
  };
  client = new LanguageClient("scenario-compiler", NAME, server, options);
  try {
    await client.start();
  } catch (fault) {
    client = undefined;
    const reason = fault instanceof Error ? fault.message : String(fault);
    const help = "Install it with: pip install 'scenario-compiler[editor]', or set scenarioCompiler.command.";
    void vscode.window.showErrorMessage(`${NAME}: '${launch.command}' does not start (${reason}). ${help}`);
  }
}

/** Show a picture beside the text; the client of the protocol would open it as text. */
async function showDocument(params: { uri: string }): Promise<{ success: boolean }> {
  await vscode.commands.executeCommand("vscode.open", vscode.Uri.parse(params.uri), vscode.ViewColumn.Beside);
  return { success: true };
}
