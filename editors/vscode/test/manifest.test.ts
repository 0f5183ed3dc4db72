import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as path from "node:path";
import { test } from "node:test";

const root = path.join(__dirname, "..");
const manifest = JSON.parse(fs.readFileSync(path.join(root, "package.json"), "utf8"));
const bundle = fs.readFileSync(path.join(root, "dist", "extension.js"), "utf8");
const sources = fs.readdirSync(path.join(root, "src")).map((name) => fs.readFileSync(path.join(root, "src", name), "utf8"));

test("every setting and command of the manifest is used, and every one that is used is in the manifest", () => {
  const settings = Object.keys(manifest.contributes.configuration.properties).map((name) => name.split(".")[1]);
  const read = sources.flatMap((text) => [...text.matchAll(/settings\.get<[^>]*>\("(\w+)"/g)].map((match) => match[1]));
  assert.deepEqual(read.sort(), settings.sort());
  const commands = manifest.contributes.commands.map((one: { command: string }) => one.command);
  const registered = sources.flatMap((text) => [...text.matchAll(/registerCommand\("([\w.]+)"/g)].map((match) => match[1]));
  assert.deepEqual(registered.sort(), commands.sort());
});

test("the bundle needs nothing but the editor and Node.js", () => {
  const needed = new Set([...bundle.matchAll(/require\("([^"]+)"\)/g)].map((match) => match[1] ?? ""));
  const built = new Set(require("node:module").builtinModules as string[]);
  const others = [...needed].filter((name) => name !== "vscode" && !built.has(name.replace(/^node:/, "")));
  assert.deepEqual(others, []);
});

test("the version is the program's", () => {
  const project = fs.readFileSync(path.join(root, "..", "..", "pyproject.toml"), "utf8");
  assert.equal(/^version = "([^"]+)"/m.exec(project)?.[1], manifest.version);
});
