# shellcheck shell=bash
# Sourced: packages for an AArch64 build on another Debian machine.

WINNOW_AARCH64_PACKAGES=(g++-aarch64-linux-gnu qemu-user)

# winnow_aarch64_root FOLDER: fills FOLDER with the arm64 libraries that winnow and its tests use.
# They are only unpacked, with separate package lists: nothing is installed on the machine, so
# packages of its own architecture cannot conflict, and no root rights are needed.
winnow_aarch64_root() {
  local root=$1
  [[ -e "$root/complete" ]] && return
  local apt=$root/apt
  mkdir -p "$apt/lists/partial" "$apt/archives/partial"
  : >"$apt/status"
  local options=(
    -o APT::Architecture=arm64 -o APT::Architectures=arm64
    -o Dir::State="$apt" -o Dir::State::lists="$apt/lists" -o Dir::State::status="$apt/status"
    -o Dir::Cache="$apt" -o Debug::NoLocking=true
  )
  winnow_quietly "$root/log" apt-get "${options[@]}" update
  (cd "$apt" && winnow_quietly "$root/log" apt-get "${options[@]}" download \
    libeigen3-dev libgtest-dev librapidcheck-dev libtbb-dev libtbb12 libtbbmalloc2 libtbbbind-2-5 \
    libxsimd-dev)
  local package
  for package in "$apt"/*.deb; do
    dpkg-deb -x "$package" "$root"
  done
  rm -rf "$apt"
  touch "$root/complete"
}
