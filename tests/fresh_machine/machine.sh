# What run.sh and steps.sh share: whether a machine can be made here, and of what. Sourced.

readonly debian=bookworm  # Debian 12

# The mirror of Debian 12 in this machine's own configuration of apt; "" where there is none.
mirror_of_apt() {
  apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' 2>/dev/null |
    awk -v release="$debian" '$2 == release && $3 == "main" && !found { print $1; found = 1 }'
}

# Prints why no machine can be made here; fails where one can.
why_not() {
  [ "$(id -u)" = 0 ] || { echo "a chroot needs root"; return; }
  command -v debootstrap >/dev/null ||
    { echo "there is no debootstrap (package debootstrap: scripts/setup.sh --for fresh)"; return; }
  [ -n "$(mirror_of_apt)" ] || { echo "apt knows no mirror of Debian 12 ($debian)"; return; }
  unshare --mount --pid --fork --kill-child chroot / /bin/true 2>/dev/null ||
    { echo "this container allows no chroot in a name space of its own"; return; }
  return 1
}
