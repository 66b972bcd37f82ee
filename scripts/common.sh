# Shared by scripts/run and scripts/test: sourced, not run.

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd -P)

say() { printf '%s: %s\n' "$(basename -- "$0")" "$*" >&2; }
fail() { say "$*"; exit 1; }

# packages_of GROUP...: the names that scripts/packages.txt lists for these groups.
packages_of() {
  local group
  for group in "$@"; do
    awk -v group="$group" '$1 == group { print $2 }' "$root/scripts/packages.txt"
  done
}

is_installed() { dpkg-query -W -f='${db:Status-Status}\n' "$1" 2>/dev/null | grep -qx installed; }

# install_missing GROUP...: installs what is missing and touches neither apt nor the network when nothing is.
install_missing() {
  local package wanted missing=() as_root=()
  mapfile -t wanted < <(packages_of "$@")

  if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    say "this system has no apt, so packages cannot be installed from here."
    say "Needed, by their Debian names: ${wanted[*]}"
    command -v cmake >/dev/null && command -v ninja >/dev/null || fail "cmake and ninja not found: install the above, then start again"
    say "cmake and ninja are here: going on with what is installed"
    return
  fi

  for package in "${wanted[@]}"; do
    is_installed "$package" || missing+=("$package")
  done
  ((${#missing[@]})) || return 0

  if ((EUID != 0)); then
    command -v sudo >/dev/null || fail "missing packages, and neither root nor sudo to install them. As root: apt-get install --no-install-recommends ${missing[*]}"
    as_root=(sudo)
  fi
  say "installing ${missing[*]}"
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=600)
  "${apt[@]}" update || say "the package lists could not be refreshed: trying with those that are here"
  "${apt[@]}" install -y --no-install-recommends "${missing[@]}" || fail "installing failed (network? rights?): ${missing[*]}"
}

# build_preset PRESET [cmake option|target...]: configures and builds into build/PRESET, everything where no target is named.
build_preset() {
  local preset=$1 launcher=() settings=() targets=() word
  shift
  for word in "$@"; do
    if [[ $word == -* ]]; then settings+=("$word"); else targets+=("$word"); fi
  done
  if command -v ccache >/dev/null; then
    launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  fi
  cmake -S "$root" --preset "$preset" "${launcher[@]}" "${settings[@]}" >&2
  cmake --build "$root/build/$preset" ${targets[@]:+--target "${targets[@]}"} >&2
}
