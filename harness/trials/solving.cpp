#include "trials/solving.h"

#include "process/ask.h"
#include "rows/codec.h"
#include "trials/verification.h"

namespace podm::bench {

Solving solve_on_mesh(const Trial& trial, const std::string& mesh_path, const std::string& program,
                      const StopQuery& stop_requested) {
  const Reply reply = ask({program, mesh_path}, timeout_of_proof_s(trial), stop_requested);
  const bool is_interrupted = reply.outcome.end == ProcessOutcome::End::kInterrupted;
  if (!reply.succeeded()) return {{}, "not solved: " + reply.failure_text(), is_interrupted};
  try {
    return {from_json<SolveRecord>(Json::parse(reply.text, nullptr, false), "solve"), "", false};
  } catch (const FieldError& error) {
    return {{}, std::string("not solved: ") + error.what(), false};
  }
}

std::string absence_of_solver(const std::string& program) {
  if (program.empty()) return "no solver is installed";
  const Reply reply = ask({program, "--version"});
  if (reply.succeeded()) return "";
  return reply.text.empty() ? program + " --version: " + reply.failure_text() : reply.text;
}

}  // namespace podm::bench
