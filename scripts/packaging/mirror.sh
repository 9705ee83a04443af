# Included by the scripts of this folder. Fetches packages of any Debian release from the mirror that this machine's apt
# uses for Debian 12, with their signatures checked.

# Prints the address of the mirror.
debian_mirror() {
  apt-get indextargets --format '$(REPO_URI) $(CODENAME) $(COMPONENT) $(CREATED_BY)' |
    awk '$2 == "bookworm" && $3 == "main" && $4 == "Packages" { print $1; exit }'
}

# apt_of FOLDER apt-get's arguments: runs apt-get with the lists and sources that FOLDER holds. Its first call puts them
# there: binary packages of Debian 11 and 13, source packages of Debian 12.
apt_of() {
  apt_folder=$1
  shift
  options="-qq -o Dir::Etc::sourcelist=$apt_folder/sources.list -o Dir::Etc::sourceparts=- \
    -o Dir::State::lists=$apt_folder/lists -o Dir::State::status=/dev/null \
    -o Dir::Cache=$apt_folder/cache -o APT::Sandbox::User=root"
  if [ ! -e "$apt_folder/sources.list" ]; then
    mirror=$(debian_mirror)
    [ -n "$mirror" ] || { echo "scripts/packaging: apt has no mirror of Debian 12 (bookworm)" >&2; return 1; }
    mkdir -p "$apt_folder/lists/partial" "$apt_folder/cache/archives/partial"
    for entry in "deb bullseye" "deb trixie" "deb-src bookworm"; do
      echo "${entry% *} $mirror ${entry#* } main"
    done > "$apt_folder/sources.list"
    # shellcheck disable=SC2086  # a list of options
    apt-get $options update || { rm "$apt_folder/sources.list"; return 1; }
  fi
  # shellcheck disable=SC2086
  apt-get $options "$@"
}
