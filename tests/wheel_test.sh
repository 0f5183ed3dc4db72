#!/usr/bin/env bash
# Runs the installed program from a folder that knows nothing of the checkout: wheel_test.sh ENVIRONMENT
set -euo pipefail
environment=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

library=$("$environment/bin/python" -I -c 'from scenario_compiler.resources import library_folder; print(library_folder())')
"$environment/bin/scenario-compiler" validate "$library"
for conflict in sensor_failure ramp_blocked road_narrows obstacle_ahead markings_missing; do
	"$environment/bin/scenario-compiler" run "$library/conflicts/$conflict.xml" --duration 3 -o "runs/$conflict"
done
"$environment/bin/scenario-compiler" map plot town_grid -o town.png
"$environment/bin/scenario-compiler" --version
"$environment/bin/scenario-compiler" schema | cmp - "$library/../schemas/conflict.xsd"
"$environment/bin/scenario-compiler" schema study | cmp - "$library/../schemas/study.xsd"
"$environment/bin/scenario-compiler" library "$library" -o covered
