import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as os from "node:os";
import * as path from "node:path";
import { test } from "node:test";

import { launchOf } from "../src/server";

test("the program on the PATH is started where the workspace has none of its own", () => {
  const launch = launchOf({ command: "", maps: [] }, ["/nowhere"], "/home/me");
  assert.deepEqual(launch, { command: "scenario-compiler", args: ["lsp", "--stdio"] });
});

test("the workspace's environment goes before the PATH, and the setting before both", () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "workspace-"));
  const program = path.join(folder, ".venv", "bin", "scenario-compiler");
  fs.mkdirSync(path.dirname(program), { recursive: true });
  fs.writeFileSync(program, "");
  assert.equal(launchOf({ command: "", maps: [] }, ["/nowhere", folder], "/home/me").command, program);
  assert.equal(launchOf({ command: " ~/bin/sc ", maps: [] }, [folder], "/home/me").command, "/home/me/bin/sc");
  fs.rmSync(folder, { recursive: true });
});

test("folders of maps are given with the workspace's folder before them", () => {
  const launch = launchOf({ command: "", maps: ["maps", "~/towns", "/srv/maps"] }, ["/srv/library"], "/home/me");
  const maps = ["--maps", "/srv/library/maps", "--maps", "/home/me/towns", "--maps", "/srv/maps"];
  assert.deepEqual(launch.args, ["lsp", "--stdio", ...maps]);
});
