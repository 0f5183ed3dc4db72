/** The real server, started as the extension starts it and spoken to as the editor speaks, without a window. */

import assert from "node:assert/strict";
import { type ChildProcess, spawn } from "node:child_process";
import * as fs from "node:fs";
import * as os from "node:os";
import * as path from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import {
  CodeLensRequest,
  CompletionRequest,
  type CompletionList,
  createProtocolConnection,
  DefinitionRequest,
  type Diagnostic,
  DidChangeTextDocumentNotification,
  DidOpenTextDocumentNotification,
  ExecuteCommandRequest,
  ExitNotification,
  HoverRequest,
  InitializedNotification,
  InitializeRequest,
  type Location,
  PublishDiagnosticsNotification,
  RenameRequest,
  ShowDocumentRequest,
  ShutdownRequest,
  StreamMessageReader,
  StreamMessageWriter,
  type ProtocolConnection,
} from "vscode-languageserver-protocol/node";

import { launchOf } from "../src/server";

const ROOT = path.resolve(__dirname, "..", "..", "..");
const PROGRAM = process.env["SCENARIO_COMPILER"] ?? "";
const FILE = path.join(ROOT, "library", "conflicts", "obstacle_ahead.xml");
const TEXT = fs.readFileSync(FILE, "utf8");

let server: ChildProcess;
let connection: ProtocolConnection;
let folder: string;
let uri: string;
const published = new Map<string, Diagnostic[]>();
const shown: string[] = [];
let waiting: (() => void)[] = [];

/** Return where a piece of the text ends, as line and character. */
function behind(text: string, piece: string): { line: number; character: number } {
  const lines = text.slice(0, text.indexOf(piece) + piece.length).split("\n");
  return { line: lines.length - 1, character: lines.at(-1)?.length ?? 0 };
}

async function found(wanted: (found: Diagnostic[]) => boolean): Promise<Diagnostic[]> {
  for (;;) {
    const now = published.get(uri);
    if (now !== undefined && wanted(now)) {
      return now;
    }
    await new Promise<void>((resolve) => waiting.push(resolve));
  }
}

before(async () => {
  folder = fs.mkdtempSync(path.join(os.tmpdir(), "vscode-"));
  uri = pathToFileURL(path.join(folder, "conflict.xml")).toString();
  const launch = launchOf({ command: PROGRAM, maps: [] }, [ROOT], os.homedir());
  server = spawn(launch.command, launch.args, { stdio: ["pipe", "pipe", "inherit"] });
  assert.ok(server.stdout && server.stdin);
  connection = createProtocolConnection(new StreamMessageReader(server.stdout), new StreamMessageWriter(server.stdin));
  connection.onNotification(PublishDiagnosticsNotification.type, (params) => {
    published.set(params.uri, params.diagnostics);
    const woken = waiting;
    waiting = [];
    woken.forEach((wake) => wake());
  });
  connection.onRequest(ShowDocumentRequest.type, (params) => {
    shown.push(params.uri);
    return { success: true };
  });
  connection.listen();
  const capabilities = { textDocument: { completion: { completionItem: { snippetSupport: true } } } };
  const workspaceFolders = [{ uri: pathToFileURL(folder).toString(), name: "test" }];
  await connection.sendRequest(InitializeRequest.type, { processId: process.pid, rootUri: null, capabilities, workspaceFolders });
  await connection.sendNotification(InitializedNotification.type, {});
  const textDocument = { uri, languageId: "xml", version: 1, text: TEXT };
  await connection.sendNotification(DidOpenTextDocumentNotification.type, { textDocument });
});

after(async () => {
  await connection.sendRequest(ShutdownRequest.type);
  await connection.sendNotification(ExitNotification.type);
  connection.dispose();
  fs.rmSync(folder, { recursive: true });
});

test("a conflict of the library has no findings", async () => {
  assert.deepEqual(await found(() => true), []);
});

test("templates are offered, with what they do", async () => {
  const position = behind(TEXT, '<use template="');
  const answer = (await connection.sendRequest(CompletionRequest.type, { textDocument: { uri }, position })) as CompletionList;
  const offered = answer.items.find((item) => item.label === "cut_in");
  assert.match(offered?.detail ?? "", /changes into it/);
});

test("an attribute is explained with its unit and limits", async () => {
  const answer = await connection.sendRequest(HoverRequest.type, { textDocument: { uri }, position: behind(TEXT, "budg") });
  assert.match(JSON.stringify(answer?.contents), /number in s, above 0/);
});

test("a template's definition is its file", async () => {
  const position = behind(TEXT, '<use template="b');
  const answer = (await connection.sendRequest(DefinitionRequest.type, { textDocument: { uri }, position })) as Location;
  assert.ok(answer.uri.endsWith("/library/templates/blocked_lane.xml"), answer.uri);
});

test("a parameter gets another name everywhere", async () => {
  const position = behind(TEXT, '<parameter name="d');
  const params = { textDocument: { uri }, position, newName: "renamed" };
  const edit = await connection.sendRequest(RenameRequest.type, params);
  const uses = TEXT.split("$distance").length - 1;
  assert.equal(edit?.changes?.[uri]?.length, 1 + uses);
});

test("the lens over a scenario draws its plan", async () => {
  const [lens] = (await connection.sendRequest(CodeLensRequest.type, { textDocument: { uri } })) ?? [];
  assert.equal(lens?.command?.title, "Preview");
  const params = { command: lens?.command?.command ?? "", arguments: lens?.command?.arguments ?? [] };
  const picture: string = await connection.sendRequest(ExecuteCommandRequest.type, params);
  assert.equal(fs.readFileSync(picture).subarray(1, 4).toString(), "PNG");
  assert.deepEqual(shown, [pathToFileURL(picture).toString()]);
});

test("findings follow the text", async () => {
  const wrong = TEXT.replace('preset="study_means"', 'preset="study_mean"');
  const change = (version: number, text: string) =>
    connection.sendNotification(DidChangeTextDocumentNotification.type, {
      textDocument: { uri, version },
      contentChanges: [{ text }],
    });
  await change(2, wrong);
  const [finding] = await found((now) => now.length > 0);
  assert.equal(finding?.code, "SC218");
  assert.match(JSON.stringify(finding?.message), /did you mean 'study_means'/);
  await change(3, TEXT);
  await found((now) => now.length === 0);
});
