// The rules that rows of a submission keep. Each function adds a fault for each row that breaks one of its
// rules. They read only the submission; remesh.h makes meshes again.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/experiment.h"
#include "submissions/submission.h"

namespace podm::bench {

/// The key of each row follows from its mesher, input, options, machine and repeat. No key occurs twice.
void check_keys(const Submission& submission, Faults& faults);

/// Clean programs with their hashes made each row, podm-verify judged each mesh, and the status follows from
/// the guarantees and verdicts. Equal inputs have equal hashes, and so do meshes that one thread makes.
void check_programs(const Submission& submission, Faults& faults);
void check_status(const Submission& submission, Faults& faults);
void check_hashes_of_rows(const Submission& submission, Faults& faults);

/// Each row names its machine. All measured rows of an experiment are of one machine, because ratios compare
/// them.
void check_machines(const Submission& submission, Faults& faults);

/// The clock of a row: no phase is negative, all phases together end within the process, processor time fits
/// the processors, and the rates are the cells over the seconds of their phases. The numbers of cells agree:
/// the cells of all labels, and six dihedral angles per cell.
void check_clock(const Submission& submission, Faults& faults);

/// Each row with a mesh has the mesher's record and the verifier's report, and agrees with both.
void check_logs(const Submission& submission, Faults& faults);

/// Closed: each row has the input and the bounds of a trial of `experiments`; a row of podm also has its
/// options. Open: the submission declares something. `experiments` returns the suite's experiments as they
/// are expanded on a machine with this number of usable processors.
using ExperimentsOn = std::function<const std::vector<Experiment>&(int processors)>;
void check_division(const Submission& submission, const ExperimentsOn& experiments, Faults& faults);

/// Returns the trial of a closed division that the row ran; null if there is none.
const Trial* trial_of(const Row& row, const std::vector<Experiment>& experiments);

}  // namespace podm::bench
