# Sourced by scripts that need Debian packages and Python environments; they define say() before.

# install_packages NAME...: with apt, those that are missing. Without root or sudo it says what root has to run, and ends.
install_packages() {
  local package missing=() as_root=()
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done
  if ((${#missing[@]} == 0)); then
    say "Debian packages: all $# are installed"
    return
  fi
  if ((EUID != 0)); then
    command -v sudo >/dev/null || { say "run this once as root: apt-get install ${missing[*]}"; exit 1; }
    as_root=(sudo)
  fi
  say "installing ${#missing[@]} packages: ${missing[*]}"
  "${as_root[@]}" apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
}

# make_environment FOLDER LOCK: a Python environment that holds what the lock file pins; a copy of the file is left there
# as a stamp (bench/runner.py does the same with the environments of benchmarks, before anything else is installed).
# It is made of the system's Python, so that it does not depend on what else is on the PATH.
make_environment() {
  local folder=$1 lock=$2 python=${PILOTFISH_PYTHON:-/usr/bin/python3}
  if [ ! -x "$folder/bin/python" ]; then
    say "making $folder with $("$python" --version)"
    "$python" -m venv "$folder"
  fi
  if cmp -s "$lock" "$folder/requirements.installed"; then
    say "the Python packages in $folder are up to date"
    return
  fi
  say "installing $lock into $folder"
  "$folder/bin/python" -m pip install -qq --disable-pip-version-check -r "$lock"
  cp "$lock" "$folder/requirements.installed"
}
