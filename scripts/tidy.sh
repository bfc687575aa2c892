#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs clang-tidy, with .clang-tidy, over the sources that changed; a warning is an error.
#   scripts/tidy.sh [--since COMMIT] [--minutes N] [FILE...]
# Without files: those that differ from COMMIT, or were changed by the commits of the last day,
# latest first; and those with uncommitted changes. A source is checked with the headers that it
# includes. With --minutes no check starts after N minutes, and the number of unchecked sources is
# printed. Exit status: 0 no warnings, 1 warnings, 2 it cannot run.
set -euo pipefail
cd "$(dirname "$0")/.."

since= minutes=
while [[ "${1:-}" == --* ]]; do
  [ $# -ge 2 ] || { echo "tidy.sh: $1 needs a value" >&2; exit 2; }
  case "$1" in
    --since) since=$2 ;;
    --minutes) minutes=$2 ;;
    *) echo "tidy.sh: unknown option '$1'; it knows --since and --minutes" >&2; exit 2 ;;
  esac
  shift 2
done
[[ "$minutes" =~ ^([1-9][0-9]*)?$ ]] ||
  { echo "tidy.sh: --minutes: expected a whole number above 0, not '$minutes'" >&2; exit 2; }
command -v clang-tidy >/dev/null ||
  { echo "tidy.sh: no clang-tidy; scripts/setup.sh --for check installs it" >&2; exit 2; }

if [ $# -gt 0 ]; then
  files=("$@")
else
  [ -z "$since" ] || git rev-parse --quiet --verify "$since^{commit}" >/dev/null ||
    { echo "tidy.sh: no commit '$since' here" >&2; exit 2; }
  mapfile -t files < <({
    git ls-files --others --modified --exclude-standard -- '*.cpp'
    if [ -n "$since" ]; then git diff --name-only "$since" -- '*.cpp'
    else git log --since='1 day ago' --name-only --pretty=format: -- '*.cpp'; fi
  } | awk 'NF && !seen[$0]++')
fi
# Commands that compile each source separately, without the precompiled headers of another compiler.
mkdir -p build
cmake -S . -B build/tidy -G Ninja -DCMAKE_BUILD_TYPE=Debug -DLAPWING_TESTS=ON -DLAPWING_UNITY=OFF \
  -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >build/tidy.log 2>&1 ||
  { tail -n 30 build/tidy.log >&2; exit 2; }

# Sources without a target (templates, generated ones) have no command.
known=()
for file in "${files[@]}"; do
  ! grep -qF "\"file\": \"$PWD/$file\"" build/tidy/compile_commands.json || known+=("$file")
done
echo "clang-tidy: ${#known[@]} sources ..."
[ ${#known[@]} -gt 0 ] || exit 0
tidy_one() {
  if [ -n "$2" ] && [ "$(date +%s)" -ge "$2" ]; then echo "$1" >>build/tidy.left_out; return; fi
  clang-tidy -p build/tidy --quiet --warnings-as-errors='*' "$1" 2>/dev/null
}
export -f tidy_one
end=
[ -z "$minutes" ] || end=$(($(date +%s) + 60 * minutes))
rm -f build/tidy.left_out
status=0
printf '%s\0' "${known[@]}" | xargs -0 -n 1 -P 2 -I '{}' bash -c 'tidy_one "$0" "$1"' '{}' "$end" ||
  status=1
[ ! -f build/tidy.left_out ] ||
  echo "clang-tidy: $(wc -l <build/tidy.left_out) of ${#known[@]} sources left out after $minutes min"
exit "$status"
