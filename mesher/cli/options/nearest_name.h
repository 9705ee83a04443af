// "Did you mean": the known name nearest to a misspelt one.
#pragma once

#include <string>
#include <vector>

namespace podm::cli {

/// Returns ", did you mean 'NAME'?" for the candidate with the smallest edit distance; empty if none is near.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace podm::cli
