#!/bin/sh
# Usage: ci/packages.sh [wheel|older|deb|sdist|processor...]
# Makes the wheel, the source distribution and the Debian packages, and uses each on a system that was made for it.
# There the podm of wheel and Debian packages makes the meshes of results/reference/canonical_hashes.json.
# Needs root, and a mirror of Debian. Keeps nothing. Without words it makes all of these checks:
#   wheel      on Debian 12 with Python, numpy and pip, and nothing else, pip installs the wheel without a network
#   older      on Debian 11, whose glibc is 2.31, the programs of the wheel run
#   deb        on Debian 12 with nothing else, apt installs, removes and purges the packages; lintian finds no error
#   sdist      pip builds the source distribution
#   processor  a processor without AVX2 gets one sentence from each program of the build and of the wheel
# Exits with 1 if one fails.
set -eu
cd "$(dirname "$0")/.."
[ "$(id -u)" = 0 ] || { echo "ci/packages.sh: making a system needs root" >&2; exit 2; }
[ $# -gt 0 ] || set -- wheel older deb sdist processor
. scripts/packaging/mirror.sh
scripts/setup build python packaging
built=$PWD/build-profiled
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
version=$(sed -n 's/^project(podm VERSION \([^ ]*\).*/\1/p' CMakeLists.txt)

# Makes the system $scratch/$1 of the Debian release $2 with the packages $3, and puts the test there.
make_system() {
  mmdebstrap --quiet --variant=minbase --include="$3" "$2" "$scratch/$1" "$(debian_mirror)"
  mkdir "$scratch/$1/podm"
  cp scripts/packaging/tests/use_podm.py "$scratch/$1/podm"
  cp -r --parents scripts/canonical_hashes scripts/docs scripts/figures experiments/machines \
    results/reference/canonical_hashes.json "$scratch/$1/podm"
}

# In a system: podm makes the committed meshes.
hashes='python3 -B scripts/canonical_hashes --podm "$(command -v podm)"'

# Runs the command $2 in the system $1. Its mounts end with it.
in_system() {
  unshare --mount sh -c 'for d in proc sys dev; do mount --rbind /$d "$0/$d"; done
    cp /etc/resolv.conf "$0/etc/resolv.conf"
    exec chroot "$0" env -i PATH=/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin HOME=/root \
      DEBIAN_FRONTEND=noninteractive PODM_EXPECTED_VERSION="$1" sh -euc "cd /podm; $2"' "$scratch/$1" "$version" "$2"
}

check_wheel() {
  make_system wheel bookworm python3,python3-numpy,python3-pip
  cp "$wheel" "$scratch/wheel/podm"
  find "$scratch/wheel" -name '*podm*' | sort > "$scratch/before"
  start=$(date +%s)
  in_system wheel 'python3 -m pip install --quiet --no-index --break-system-packages --root-user-action=ignore ./*.whl
    podm phantom abdomen --size 64 -o seg.nii.gz
    podm mesh seg.nii.gz --radius 16 --quiet -o mesh.vtu'
  echo "from the wheel to a first mesh: $(($(date +%s) - start)) s"
  in_system wheel "$hashes"
  in_system wheel 'python3 -B use_podm.py; python3 -m pip uninstall --quiet --yes --break-system-packages podmark
    rm -rf mesh.vtu mesh_facets.vtu seg.nii.gz'
  find "$scratch/wheel" -name '*podm*' | sort | diff "$scratch/before" -
}

check_older() {
  make_system older bullseye python3
  python3 -m zipfile -e "$wheel" "$scratch/older/podm"
  in_system older 'chmod +x podm/bin/*; export PATH=/podm/podm/bin:$PATH
    PODM_WITHOUT_PACKAGE=1 python3 -B use_podm.py
    '"$hashes"
}

check_deb() {
  # shellcheck disable=SC2086  # a list of files, here and below
  lintian --allow-root --fail-on error $debs
  make_system deb bookworm apt-utils
  cp $debs "$scratch/deb/podm"
  cp -r examples/mesh_image "$scratch/deb/podm"
  find "$scratch/deb" -name '*podm*' | sort > "$scratch/before"
  in_system deb 'apt-get update -qq
    apt-get install -qq --no-install-recommends ./*.deb > log 2>&1 || { tail log; exit 1; }
    python3 -B use_podm.py
    '"$hashes"'
    test -s /usr/share/man/man1/podm.1.gz
    test -s /usr/share/bash-completion/completions/podm
    apt-get install -qq --no-install-recommends cmake g++ make > log 2>&1
    cmake -S mesh_image -B example -DCMAKE_BUILD_TYPE=Release > log && cmake --build example >> log
    example/mesh_image phantom:spheres@24 5 example.vtu
    podm-verify example.vtu
    apt-get purge -qq podmark podmark-mpi podmark-dev python3-podm > log 2>&1
    if command -v podm; then exit 1; fi
    rm -rf example example.vtu'
  find "$scratch/deb" -name '*podm*' | sort | diff "$scratch/before" -
}

check_sdist() {
  /usr/bin/python3 -m venv --system-site-packages "$scratch/env"
  PODM_BUILD="$scratch/build" "$scratch/env/bin/python3" -m pip install --quiet --no-index --no-build-isolation \
    dist/podmark-"$version".tar.gz
  (cd "$scratch" && PODM_EXPECTED_VERSION=$version PATH=$scratch/env/bin:$PATH "$scratch/env/bin/python3" -B \
    "$OLDPWD/scripts/packaging/tests/use_podm.py" Installation.test_programs_report_the_version_of_the_package \
    Installation.test_the_package_meshes_an_array_and_proves_the_mesh)
}

check_processor() {
  python3 -m zipfile -e "$wheel" "$scratch/processor"
  chmod +x "$scratch"/processor/podm/bin/*
  for folder in "$built/bin" "$scratch/processor/podm/bin"; do
    for program in "$folder/podm" "$folder/podm-verify" "$folder/podm-bench"; do
      code=0
      said=$(qemu-x86_64 -cpu Westmere "$program" --version 2>&1) || code=$?
      echo "$program on a processor of 2010: $said"
      [ "$code" = 2 ] && [ "$(echo "$said" | grep -c AVX2)" = 1 ] && [ "$(echo "$said" | wc -l)" = 1 ] || return 1
    done
  done
}

rm -rf dist
make wheel deb sdist
PODM_BUILD=$built /usr/bin/python3 -B scripts/packaging/tests/test_packaging.py
wheel=$(ls "$PWD"/dist/*-cp311-*.whl)
debs=$(ls "$PWD"/dist/*.deb)
for check; do
  echo "== $check"
  "check_$check"
done
