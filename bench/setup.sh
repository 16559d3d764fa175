# shellcheck shell=bash
# Sourced by bench/run and tests/run: installs the packages that a bare Debian 12 lacks.

# Required by every build of winnow.
WINNOW_BUILD_PACKAGES=(cmake ninja-build g++ pkg-config libeigen3-dev libxsimd-dev libtbb-dev)
# Also required by the winnow tool.
WINNOW_BENCH_PACKAGES=(libcli11-dev nlohmann-json3-dev liblzma-dev xz-utils
                       libjs-three libjs-chart.js libbenchmark-dev)
# Required by the Python package, and by its tests.
WINNOW_PYTHON_PACKAGES=(pybind11-dev python3-dev python3-numpy)
WINNOW_PYTHON_TEST_PACKAGES=(python3-pytest python3-hypothesis python3-venv mypy python3-mpi4py)
# Clusters over MPI, and Zoltan, which divides space for them.
WINNOW_CLUSTER_PACKAGES=(libopenmpi-dev openmpi-bin libtrilinos-zoltan-dev)
# Required by bench/site/build: mkdocs with Pygments for pages, and Doxygen for the reference.
WINNOW_SITE_PACKAGES=(mkdocs python3-pygments doxygen)
# The spell checker of the test house_spelling.
WINNOW_SPELLING_PACKAGES=(codespell)
# Headless Chromium, in which tests open the pages of `winnow view`.
WINNOW_BROWSER_PACKAGES=(chromium-headless-shell)
# Other libraries that winnow can be compared with.
WINNOW_PEER_PACKAGES=(libbullet-dev libfcl-dev libcgal-dev libembree-dev libode-dev
                      libccd-dev)

# winnow_missing PACKAGE...: prints the packages that are not installed.
winnow_missing() {
  local package
  for package in "$@"; do
    [[ "$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null)" == "install ok installed" ]] ||
      printf '%s\n' "$package"
  done
}

# winnow_need PACKAGE...: installs missing packages and prints their names. If it lacks the right to
# install, it prints the command and returns 1. On systems without dpkg it does nothing, and CMake has to
# find the dependencies.
winnow_need() {
  command -v dpkg-query >/dev/null || return 0
  local missing
  mapfile -t missing < <(winnow_missing "$@")
  ((${#missing[@]})) || return 0

  local as_root=()
  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null || ! { sudo -n true 2>/dev/null || [[ -t 0 ]]; }; then
      echo "Packages are missing and installing them needs root. Run:" >&2
      echo "  apt-get install -y --no-install-recommends ${missing[*]}" >&2
      return 1
    fi
    as_root=(sudo)
  fi
  echo "installing: ${missing[*]}" >&2
  local log
  log=$(mktemp)
  # A failed update is ignored: old package lists may suffice.
  if ! { "${as_root[@]}" apt-get update || true
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
      apt-get install -y --no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
    cat "$log" >&2
    rm -f "$log"
    echo "Installing failed. The command was:" >&2
    echo "  ${as_root[*]:+${as_root[*]} }apt-get install -y --no-install-recommends ${missing[*]}" >&2
    return 1
  fi
  rm -f "$log"
}

# winnow_minutes SECONDS: prints how long this machine takes for work that takes one core SECONDS.
winnow_minutes() {
  local cores
  cores=$(nproc)
  printf 'about %d minutes on %d cores' $((($1 / cores + 59) / 60)) "$cores"
}

# winnow_steps LOG: copies standard input to LOG and prints the number of finished ninja steps to standard
# error: in place on a terminal, otherwise after each tenth of them.
winnow_steps() {
  local line printed=-1 began=$SECONDS
  while IFS= read -r line; do
    printf '%s\n' "$line"
    [[ $line =~ ^\[([0-9]+)/([0-9]+)\] ]] || continue
    local step=${BASH_REMATCH[1]} steps=${BASH_REMATCH[2]}
    local tenth=$((10 * step / steps))
    if [[ -t 2 ]]; then
      printf '\r\033[K%d of %d steps, %d s' "$step" "$steps" $((SECONDS - began)) >&2
    elif ((tenth > printed)); then
      printf '%d of %d steps, %d s\n' "$step" "$steps" $((SECONDS - began)) >&2
    fi
    printed=$tenth
  done >"$1"
  [[ ! -t 2 ]] || printf '\r\033[K' >&2
}

# winnow_build FOLDER PRESET TARGET [CMAKE OPTION...]: configures and builds one target and prints the
# progress; prints the log if that fails.
winnow_build() {
  local folder=$1 preset=$2 target=$3
  shift 3
  local log="$folder/build/$preset.log"
  mkdir -p "$folder/build"
  if ! { cmake -S "$folder" --preset "$preset" "$@" &&
    cmake --build "$folder/build/$preset" --target "$target"; } 2>&1 | winnow_steps "$log"; then
    cat "$log" >&2
    echo "The build failed; its log is $log" >&2
    return 1
  fi
}

# winnow_quietly LOG COMMAND...: shows the command's output only if it fails.
winnow_quietly() {
  local log=$1
  shift
  "$@" >"$log" 2>&1 || {
    cat "$log" >&2
    echo "failed: $*" >&2
    return 1
  }
}
