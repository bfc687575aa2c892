# SPDX-License-Identifier: Apache-2.0
# Packages of Node by their lock file, outside of the sources; sourced by the other scripts.

# install_node_packages FOLDER: those of FOLDER/package-lock.json go to build/node/FOLDER, and
# FOLDER/node_modules leads there. Nothing happens where they are there already.
install_node_packages() {
  local folder=$1 place=build/node/$1 way
  scripts/setup.sh --yes --for studio
  mkdir -p "$place"
  if ! cmp -s "$folder/package-lock.json" "$place/package-lock.json" ||
    [ ! -e "$place/node_modules/.package-lock.json" ]; then
    cp "$folder/package.json" "$place"
    cp "$folder/package-lock.json" "$place/package-lock.json.new"
    mv "$place/package-lock.json.new" "$place/package-lock.json"
    npm ci --prefix "$place" --no-audit --no-fund >"$place/npm.log" 2>&1 || {
      tail -n 20 "$place/npm.log" >&2
      rm -f "$place/package-lock.json"
      return 1
    }
  fi
  way=$(realpath -m --relative-to="$folder" "$place/node_modules")
  ln -sfn "$way" "$folder/node_modules"
}
