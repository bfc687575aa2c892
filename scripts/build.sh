# SPDX-License-Identifier: Apache-2.0
# Configuring and building, sourced by the other scripts. Everything that CMake and the compiler say
# goes to build/PRESET.log; a failure prints its end.

# lapwing_configure PRESET [CMake options]: configures a folder that is not, and one whose options
# differ from the given (as -DNAME=VALUE). Options that are not given stay as they are.
lapwing_configure() {
  local preset=$1 log="build/$1.log" cache="build/$1/CMakeCache.txt" option name needed=false
  shift
  mkdir -p build
  [ -f "build/$preset/build.ninja" ] || needed=true
  for option in "$@"; do
    name=${option#-D}
    $needed || grep -q "^${name%%=*}:[A-Z]*=${name#*=}\$" "$cache" || needed=true
  done
  $needed || return 0
  echo "Configuring ($preset) ..." >&2
  cmake --preset "$preset" "$@" >"$log" 2>&1 || { tail -n 30 "$log" >&2; return 1; }
}

# lapwing_build PRESET TARGET...: configures if that was never done, and builds quietly.
lapwing_build() {
  local preset=$1 log="build/$1.log" began=$SECONDS
  shift
  lapwing_configure "$preset" || return 1
  [ -t 2 ] && echo "Building ($preset), log in $log ..." >&2
  cmake --build --preset "$preset" --target "$@" >>"$log" 2>&1 || { tail -n 40 "$log" >&2; return 1; }
  lapwing_build_seconds=$((SECONDS - began))
}
