# SPDX-License-Identifier: Apache-2.0
# Functions of run.sh and steps.sh: whether a machine can be made here, and from which mirror.
# Sourced.

readonly debian=bookworm  # Debian 12

# The mirror of Debian 12 in the apt configuration of this machine; "" if there is none.
mirror_of_apt() {
  apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' 2>/dev/null |
    awk -v release="$debian" '$2 == release && $3 == "main" && !found { print $1; found = 1 }'
}

# Prints why no machine can be made here; fails if one can be made.
why_not() {
  [ "$(id -u)" = 0 ] || { echo "a chroot needs root"; return; }
  command -v debootstrap >/dev/null ||
    { echo "debootstrap is not installed (scripts/setup.sh --for fresh installs it)"; return; }
  [ -n "$(mirror_of_apt)" ] || { echo "apt knows no mirror of Debian 12 ($debian)"; return; }
  unshare --mount --pid --fork --kill-child chroot / /bin/true 2>/dev/null ||
    { echo "this container allows no chroot in a separate name space"; return; }
  return 1
}

# commands_of README HEADING: the commands of the shell snippets of a section, in order. A Lua
# snippet becomes the file that its first line names.
commands_of() {
  awk -v heading="$2" '
    !fenced && /^## / { inside = index($0, heading) == 1 }
    /^```/ {
      if (fenced && taking && lua) print "END_OF_SNIPPET"
      fenced = !fenced
      taking = fenced && inside && /^```(sh|lua)( |$)/
      lua = /^```lua/
      first = 1
      next
    }
    !taking { next }
    first && lua { print "cat >" $2 " <<\047END_OF_SNIPPET\047" }
    { first = 0; ++count; print }
    END { if (!count) { print "no snippet under \047" heading "\047" >"/dev/stderr"; exit 1 } }' "$1"
}
