#include "delaunay/lock_contract.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <unordered_map>

#include "delaunay/mesh.h"
#include "runtime/fibre.h"

namespace podm {

namespace {

// The attempts of this thread, by fibre, as a fibre may stop in the middle of an attempt; nullptr: no fibre.
thread_local std::unordered_map<const Fibre*, const AttemptScope*> attempts;

// ci/race.sh sets it where the thread sanitizer alone has to find a planted fault.
const bool is_off = std::getenv("PODM_NO_LOCK_CONTRACT") != nullptr;

const AttemptScope* attempt_at_hand() {
  if (is_off) return nullptr;
  const auto found = attempts.find(Fibre::current());
  return found != attempts.end() ? found->second : nullptr;
}

template <class Counts>
int num_vertices(const Mesh& mesh, CellId c, const Counts& counts) {
  const auto vertices = mesh.peek_vertices(c);
  if (vertices[0] == vertices[1]) return 0;  // no living cell
  return static_cast<int>(std::count_if(vertices.begin(), vertices.end(), [&](VertexId v) {
    return v != kNoVertex && counts(mesh.vertex(v));
  }));
}

int num_held(const AttemptScope& attempt, const Mesh& mesh, CellId c) {
  return num_vertices(mesh, c, [&](const Vertex& v) { return attempt.holds(v); });
}

int num_changeable(const AttemptScope& attempt, const Mesh& mesh, CellId c) {
  return num_vertices(mesh, c, [&](const Vertex& v) { return attempt.may_change(v); });
}

[[noreturn]] void fail(CellId c, const char* what, int num_held) {
  std::fprintf(stderr, "lock contract: cell %u is %s with %d of its vertices held\n", c, what, num_held);
  std::abort();
}

}  // namespace

void AttemptScope::begin() { attempts[Fibre::current()] = this; }
AttemptScope::~AttemptScope() { attempts.erase(Fibre::current()); }

void assert_may_read(const Mesh& mesh, CellId c) {
  const AttemptScope* const attempt = attempt_at_hand();
  if (attempt == nullptr) return;
  const int own = num_held(*attempt, mesh, c);
  if (own >= 2) return;
  const auto mirrors = mesh.peek_mirrors(c);
  if (mesh.peek_is_alive(c) && std::any_of(mirrors.begin(), mirrors.end(), [&](FacetId mirror) {
        return mirror != kNoFacet && num_held(*attempt, mesh, cell_of(mirror)) >= 2;
      }))
    return;
  fail(c, "read", own);
}

void assert_may_write_mirrors(const Mesh& mesh, CellId c) {
  const AttemptScope* const attempt = attempt_at_hand();
  if (attempt == nullptr) return;
  if (const int held = num_changeable(*attempt, mesh, c); held < 3) fail(c, "given a mirror", held);
}

void assert_may_replace(const Mesh& mesh, CellId c) {
  const AttemptScope* const attempt = attempt_at_hand();
  if (attempt == nullptr || !mesh.peek_is_alive(c)) return;
  if (const int held = num_changeable(*attempt, mesh, c); held < 4) fail(c, "replaced", held);
}

}  // namespace podm
