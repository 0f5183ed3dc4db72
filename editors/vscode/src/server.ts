/** How the language server is started: which program, with which arguments. Nothing here needs an editor. */

import * as fs from "node:fs";
import * as path from "node:path";

export interface Settings {
  /** The program, empty for the workspace's own or the one on the PATH; `~` is the home folder. */
  command: string;
  /** Folders in which maps are looked for first. */
  maps: readonly string[];
}

export interface Launch {
  command: string;
  args: string[];
}

/** Names of the program in an environment's folder, on Linux and macOS, and on Windows. */
const IN_ENVIRONMENT = [
  [".venv", "bin", "scenario-compiler"],
  [".venv", "Scripts", "scenario-compiler.exe"],
];

/** Return the command line of the server for the folders of a workspace. */
export function launchOf(settings: Settings, folders: readonly string[], home: string): Launch {
  const first = folders[0] ?? "";
  const maps = settings.maps.flatMap((folder) => ["--maps", path.resolve(first, expanded(folder, home))]);
  return { command: programOf(settings.command, folders, home), args: ["lsp", "--stdio", ...maps] };
}

function programOf(command: string, folders: readonly string[], home: string): string {
  if (command.trim() !== "") {
    return expanded(command.trim(), home);
  }
  const candidates = folders.flatMap((folder) => IN_ENVIRONMENT.map((parts) => path.join(folder, ...parts)));
  return candidates.find((file) => fs.existsSync(file)) ?? "scenario-compiler";
}

function expanded(file: string, home: string): string {
  return file === "~" || file.startsWith("~/") ? path.join(home, file.slice(1)) : file;
}
