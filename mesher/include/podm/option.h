// Declarations of the options of a run. An option is declared once, beside the member that holds its value.
//
// The declarations are the source of the command line and its help, of refusals, of the options in records,
// of the keywords of the Python package, of the keys of experiments, of manual pages and of the page of
// options in the documentation. A new option is a member with its default and a line in the options() of its
// struct.
#pragma once

#include <atomic>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <tuple>
#include <type_traits>

namespace podm {

/// The part of the help that lists an option.
enum class OptionGroup { kLabels, kSize, kSurfaces, kDihedral, kLimits, kOutput, kAlgorithm, kRun };

/// Where an option is available; combined by |. Options of experiments decide the mesh or the machine that
/// makes it.
enum OptionUse : unsigned {
  kInPodm = 1,
  kOnRanks = 2,
  kInPlan = 4,
  kInPython = 8,
  kInExperiments = 16,
  kInAll = kInPodm | kOnRanks | kInPython | kInExperiments,
  kOfFiles = kInPodm | kOnRanks,  ///< the program alone writes files
};

/// Details that few options need.
struct OptionDetails {
  const char* unset = "";        ///< what the default 0, false or no text means
  const char* record = nullptr;  ///< its key in the record's `options`; null: the name, with _ for -
  unsigned uses = kInAll;
  const char* not_on_ranks = nullptr;  ///< why podm-mpi refuses it; null: it does not
  /// A real number exceeds 0 and is in this range; an integer is in it, and is at least 1 unless `least` is
  /// 0.
  double least = std::numeric_limits<double>::denorm_min(), most = std::numeric_limits<double>::infinity();
  const char* quantity = "number";       ///< what the number is: "length in mm"
  const char* help_on_ranks = nullptr;   ///< instead of `help`
  const char* unset_on_ranks = nullptr;  ///< instead of `unset`
  const char* needs = nullptr;           ///< the name of another option, without which it is refused
  const char* excludes = nullptr;        ///< the name of another option, with which it is refused
  const char* keyword = nullptr;         ///< in Python; null: the name, with _ for -
  const char* short_name = nullptr;      ///< "-o"
  bool is_required = false;
};

struct Declaration : OptionDetails {
  const char* name;  ///< "leaf-size": --leaf-size, and leaf_size in Python and in experiments
  const char* type;  ///< of the value, as help shows it: "MM"; empty for flags and choices
  OptionGroup group;
  const char* help;  ///< with units, without the default; lines end with \n
};

/// True if a real number is in the range of its option.
inline bool is_in_range(double value, const Declaration& of) {
  return std::isfinite(value) && value >= of.least && value <= of.most;
}
/// The numbers in that range: "positive percentage up to 100".
inline std::string range_text(const Declaration& of) {
  std::ostringstream text;
  text << (of.least < std::numeric_limits<double>::min() ? "positive " : "") << of.quantity;
  if (of.least >= std::numeric_limits<double>::min()) text << " of at least " << of.least;
  if (std::isfinite(of.most)) text << " up to " << of.most;
  return text.str();
}

/// A declaration and the member of a struct that holds the value.
template <class Struct, class Value>
struct Option {
  Declaration declaration;
  Value Struct::*member;
};

/// A member that is a struct with options of its own.
template <class Struct, class Inner>
struct NestedOptions {
  Inner Struct::*member;
};

template <class Struct, class Value>
constexpr Option<Struct, Value> option(Value Struct::*member, const char* name, const char* type,
                                       OptionGroup group, const char* help,
                                       const OptionDetails& details = {}) {
  return {{details, name, type, group, help}, member};
}

template <class Struct, class Inner>
constexpr NestedOptions<Struct, Inner> nested(Inner Struct::*member) {
  return {member};
}

/// Calls visit(declaration, value) for each option of a struct, in the order of their declarations.
template <class Struct, class Visit>
void for_each_option(Struct&& of, const Visit& visit) {
  const auto visit_one = [&]<class S, class V>(const Option<S, V>& each) {
    visit(each.declaration, of.*each.member);
  };
  const auto visit_inner = [&]<class S, class I>(const NestedOptions<S, I>& each) {
    for_each_option(of.*each.member, visit);
  };
  const auto visit_each = [&](const auto& each) {
    if constexpr (requires { each.declaration; }) {
      visit_one(each);
    } else {
      visit_inner(each);
    }
  };
  std::apply([&](const auto&... each) { (visit_each(each), ...); }, std::remove_cvref_t<Struct>::options());
}

/// Messages spell options in two ways: "--leaf-size" for the programs, "leaf_size" for the Python package,
/// which sets this.
inline std::atomic<bool> messages_are_for_python = false;

/// The option of this name as the user wrote it or may write it.
inline std::string spelled(const std::string& name, const char* keyword = nullptr) {
  if (!messages_are_for_python) return "--" + name;
  std::string spelling = keyword != nullptr ? keyword : name;
  for (char& c : spelling)
    if (c == '-') c = '_';
  return spelling;
}
inline std::string spelled(const Declaration& of) { return spelled(of.name, of.keyword); }

}  // namespace podm
