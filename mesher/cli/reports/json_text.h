// JSON output of the program.
#pragma once

#include <boost/preprocessor.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "podm/label_image.h"

namespace podm::cli {

/// Returns one line, newline included. Replaces bytes that are not UTF-8, which file and label names may
/// contain.
std::string json_line(const nlohmann::ordered_json& value);

/// Defines to_json() of a struct, in the struct's namespace: an object with a key for each of these members.
#define PODM_TO_JSON(Struct, ...)                                                         \
  static void to_json(nlohmann::ordered_json& json, const Struct& of) {                   \
    json = nlohmann::ordered_json::object(                                                \
        {BOOST_PP_SEQ_FOR_EACH(PODM_KEY_OF, of, BOOST_PP_VARIADIC_TO_SEQ(__VA_ARGS__))}); \
  }
#define PODM_KEY_OF(repetition, of, member) {BOOST_PP_STRINGIZE(member), of.member},

/// Returns the affine from voxel indices to RAS mm: three rows of four numbers.
nlohmann::ordered_json affine_rows(const LabelImage& image);

}  // namespace podm::cli
