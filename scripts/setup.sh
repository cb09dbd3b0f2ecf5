# Sourced by the scripts beside it: finds the project, reads the common options, installs Debian packages.

set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

no_install=false

# usage TEXT... : prints the help of the calling script.
usage() {
  printf '%s\n' "$@"
}

# packages_of SECTION... : the names listed under [SECTION] in packages.txt.
packages_of() {
  local section
  for section in "$@"; do
    awk -v wanted="[$section]" '/^\[/ {on = ($0 == wanted); next} on && NF && !/^#/ {print $1}' scripts/packages.txt
  done
}

# need_packages SECTION... : says which packages are missing and installs them, or fails with --no-install.
need_packages() {
  local missing=() package
  for package in $(packages_of "$@"); do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done
  if [ ${#missing[@]} -eq 0 ]; then
    return
  fi
  if $no_install; then
    echo "Missing Debian packages: ${missing[*]}" >&2
    echo "Run without --no-install, or: apt-get install ${missing[*]}" >&2
    exit 1
  fi
  echo "Installing Debian packages: ${missing[*]}"
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    as_root=(sudo)
  fi
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" \
    > /dev/null
}

# need_node_packages : node, npm, and what viewer/package-lock.json names. Without npm's registry the tests that need it
# skip and say so. esbuild's install script is not needed: its binary comes as a package.
need_node_packages() {
  if ! command -v node > /dev/null || ! command -v npm > /dev/null; then
    need_packages node
  fi
  local stamp=viewer/node_modules/.package-lock.json
  if $no_install || { [ -e "$stamp" ] && [ ! viewer/package-lock.json -nt "$stamp" ]; }; then
    return
  fi
  (cd viewer && npm ci --ignore-scripts --no-audit --no-fund > /dev/null) ||
    echo "npm can't install the packages of viewer/package-lock.json; the tests that need them skip." >&2
}

# configure_into FOLDER OPTION... : configures a Release build there.
configure_into() {
  local folder=$1
  shift
  mkdir -p build
  cmake --preset release -B "$folder" "$@" > build/configure.log 2>&1 || { tail -n 40 build/configure.log >&2; exit 1; }
  sed -n '/^-- Lamella /,/^-- $/p' build/configure.log
}

# configure_release OPTION... : configures build/release.
configure_release() {
  configure_into build/release "$@"
}
