# Sourced by .ci/run and ci/nightly, in the folder of the repository.

if [ -d ../shared/data/images ]; then  # real segmentations beside the checkout
  PODM_TEST_IMAGES=$(realpath ../shared/data/images)
  export PODM_TEST_IMAGES
fi

# Prints what git sees of the working tree.
tree() { git status --porcelain && git diff HEAD; }

# Runs the command $1 and sets `took` to its seconds. Returns 1 if the command fails, or if it changes the working tree:
# a test that writes there is at fault.
run_step() {
  before=$(tree)
  start=$(date +%s)
  result="passed"
  echo "== $1"
  # A shell of its own: the step may set variables and change the folder.
  sh -c "$1" || result="failed with exit code $?"
  if [ "$(tree)" != "$before" ]; then
    result="$result, left changes in the working tree"
    git status --porcelain
  fi
  took=$(($(date +%s) - start))
  echo "== $1: $result, $took s"
  [ "$result" = "passed" ]
}
