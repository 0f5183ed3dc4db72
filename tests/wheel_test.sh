#!/usr/bin/env bash
# Runs the installed program from a folder that knows nothing of the checkout: wheel_test.sh ENVIRONMENT
set -euo pipefail
environment=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

library=$("$environment/bin/python" -I -c 'from scenario_compiler.resources import library_folder; print(library_folder())')
"$environment/bin/scenario-compiler" list
"$environment/bin/scenario-compiler" validate "$library"
for conflict in "$library"/conflicts/*.xml; do
	"$environment/bin/scenario-compiler" run "$conflict" -o "runs/$(basename "$conflict" .xml)"
done
