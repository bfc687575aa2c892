# SPDX-License-Identifier: Apache-2.0
# Configuring and building, sourced by the other scripts. The output of CMake and the compiler goes
# to build/PRESET.log; a failure prints its end.

# lapwing_configure PRESET [CMake options]: configures a folder if it is not configured, or if the
# given options (-DNAME=VALUE) differ. Other options keep their values.
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

# lapwing_build PRESET TARGET...: configures if necessary, and builds quietly.
lapwing_build() {
  local preset=$1 log="build/$1.log" began=$SECONDS
  shift
  lapwing_configure "$preset" || return 1
  [ -t 2 ] && echo "Building ($preset), log in $log ..." >&2
  cmake --build --preset "$preset" --target "$@" >>"$log" 2>&1 || { tail -n 40 "$log" >&2; return 1; }
  lapwing_build_seconds=$((SECONDS - began))
}
