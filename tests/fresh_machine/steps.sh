#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The steps, in a name space of mounts and processes that run.sh made. $machine is the folder of the
# new machine, $root the checkout, $log the log file. Mounts are not visible outside.
set -euo pipefail
. "$root/tests/fresh_machine/machine.sh"
exec 3>&1 >>"$log" 2>&1 </dev/null
mount --make-rprivate /

readonly place=/srv/lapwing user=anna

# step TEXT COMMAND...: runs it and prints how long it took.
step() {
  local text=$1 began=$SECONDS
  shift
  echo "=== $text"
  if ! "$@"; then echo "  FAILED: $text" >&3; exit 1; fi
  printf '  %4d s  %s\n' $((SECONDS - began)) "$text" >&3
}

# Copies the settings of apt and network of this machine to the new one, and nowhere else.
proxies=()
for name in http_proxy https_proxy ftp_proxy no_proxy HTTP_PROXY HTTPS_PROXY NO_PROXY; do
  [ -z "${!name:-}" ] || proxies+=("$name=${!name}")
done

# in_machine MACHINE FOLDER USER HOME COMMAND: runs a line of bash there, with an empty environment.
in_machine() {
  chroot "$1" /usr/sbin/runuser -u "$3" -- /usr/bin/env -i HOME="$4" USER="$3" \
    PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin TERM=dumb \
    CCACHE_DIR=/var/cache/ccache "${proxies[@]}" bash -c "cd $2 && $5"
}
as_root() { in_machine "$machine" "$place" root /root "$1"; }
as_user() { in_machine "$machine" "$place" "$user" "/home/$user" "$1"; }

bare_debian() {
  chmod 0755 "$machine"  # the root of a machine is open to its users
  debootstrap --variant=minbase --include=git,ca-certificates "$debian" "$machine" \
    "$(mirror_of_apt)" || { cat "$machine/debootstrap/debootstrap.log"; return 1; }
  rm -rf "$machine/etc/apt"
  cp -a /etc/apt "$machine/etc/apt"
  cp -an /usr/share/keyrings/. "$machine/usr/share/keyrings/"
  # A temporary machine needs no sync.
  echo force-unsafe-io >"$machine/etc/dpkg/dpkg.cfg.d/unsafe-io"
  cp -L /etc/resolv.conf /etc/hosts "$machine/etc/"
  local ca=/usr/local/share/ca-certificates
  [ ! -d $ca ] || cp -a $ca/. "$machine$ca/"
  chroot "$machine" update-ca-certificates
}

# mounts MACHINE
mounts() {
  local device machine=$1
  mount -t proc proc "$machine/proc"
  mount -t tmpfs -o mode=1777 tmpfs "$machine/tmp"
  mount -t tmpfs -o mode=0755 tmpfs "$machine/dev"
  for device in null zero full random urandom tty; do
    : >"$machine/dev/$device"
    mount --bind "/dev/$device" "$machine/dev/$device"
  done
  ln -s /proc/self/fd "$machine/dev/fd"
  for device in 0:stdin 1:stdout 2:stderr; do
    ln -s "/proc/self/fd/${device%:*}" "$machine/dev/${device#*:}"
  done
  mkdir "$machine/dev/shm" "$machine/dev/pts"
  mount -t tmpfs -o mode=1777 tmpfs "$machine/dev/shm"
  mount -t devpts -o newinstance,ptmxmode=0666 devpts "$machine/dev/pts"
  ln -s pts/ptmx "$machine/dev/ptmx"
}

# A second bare machine, for the installation of the package without sources.
readonly bare="$machine/var/bare"
copy_of_bare() {
  mkdir "$bare"
  tar -C "$machine" --exclude=./var/bare -c . | tar -C "$bare" -x
}

# apt installs the package of scripts/package.sh there. The program then runs the first example and
# lists its plugins.
package() {
  as_root "bash scripts/package.sh" || return 1
  cp "$machine$place"/build/lapwing_*.deb "$bare/root/"
  mounts "$bare"
  in_machine "$bare" /root root /root "
set -e
apt-get update -q
apt-get install -y -q --no-install-recommends ./lapwing_*.deb
lapwing version
lapwing plugins list
lapwing run /usr/share/lapwing/examples/filming/castle_flyover.lua
test -s out/castle_flyover/report.html
test -s /usr/share/man/man1/lapwing.1"
}

# A copy of the tracked and untracked files of git, without the ignored ones.
checkout() {
  rm -rf "$machine$place"
  mkdir -p "$machine$place"
  git -C "$root" ls-files -z --cached --others --exclude-standard |
    (cd "$root" && while IFS= read -r -d '' file; do
       [ ! -e "$file" ] && [ ! -L "$file" ] || printf '%s\0' "$file"
     done) |
    tar -C "$root" -c --null -T - | tar -C "$machine$place" -x --no-same-owner
  chroot "$machine" chown -R "$1:" "$place"
}

a_user_with_sudo() {
  as_root "apt-get install -y -q --no-install-recommends sudo" &&
    chroot "$machine" useradd -m -s /bin/bash "$user" &&
    echo "$user ALL=(ALL) NOPASSWD: ALL" >"$machine/etc/sudoers.d/$user" &&
    chroot "$machine" chown -R "$user:" /var/cache/ccache &&
    # Both commands then have something to install by sudo.
    as_root "apt-get purge -y -q make ninja-build libgmock-dev libgtest-dev"
}

# The commands are read from the READMEs.
mapfile -t typed < <(commands_of "$root/README.md" '## Two commands' | sed 's/ *# .*//')
[ ${#typed[@]} -eq 2 ] || { echo "README.md: expected two commands, not ${#typed[@]}" >&3; exit 1; }
readonly first=${typed[0]} second=${typed[1]}
install=$(commands_of "$root/README.md" '## `lapwing` as a command' | grep '^cmake ')
guide=$(commands_of "$root/plugins/README.md" '## A first cost term')

# The plugin of the guide, built against the installation; then installed beside it, as in the
# guide, and used without --plugin-path.
plugin() {
  as_user "
set -e
$install
export PATH=~/.local/bin:\$PATH CMAKE_PREFIX_PATH=~/.local
mkdir ~/work
cd ~/work
$guide
cmake --install keep_low/build
lapwing run low.lua -o again"
}

echo "A bare Debian 12 in $machine" >&3
step "a bare Debian 12, with git" bare_debian
copy_of_bare
mounts "$machine"
mkdir -p "$machine/var/cache/ccache"
checkout root
step "as root: $first" as_root "$first"
step "as root: $second" as_root "$second"
step "scripts/package.sh, and its package on a bare Debian 12" package
step "a user with sudo" a_user_with_sudo
checkout "$user"
step "as a user: $first" as_user "$first"
# The longest programs do not depend on the user, and ran as root.
step "as a user: $second -E ^missions" as_user "$second -E ^missions"
step "cmake --install, and a plugin against it" plugin
