# build PRESET TARGET...: configures if needed and builds quietly; sourced by the other scripts.
# Everything goes to build/PRESET.log; a failure prints its end.

lapwing_build() {
  local preset=$1 log
  shift
  mkdir -p build
  log="build/$preset.log"
  local began=$SECONDS
  if [ ! -f "build/$preset/build.ninja" ]; then
    echo "Configuring ($preset) ..." >&2
    cmake --preset "$preset" >"$log" 2>&1 || { tail -n 30 "$log" >&2; return 1; }
  fi
  [ -t 2 ] && echo "Building ($preset), log in $log ..." >&2
  cmake --build --preset "$preset" --target "$@" >>"$log" 2>&1 || { tail -n 40 "$log" >&2; return 1; }
  lapwing_build_seconds=$((SECONDS - began))
}
