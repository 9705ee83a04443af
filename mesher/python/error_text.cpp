#include "python/error_text.h"

#include <algorithm>
#include <regex>

namespace podm::python {
namespace {

std::string keyword_of(std::string option) {
  if (option == "labels") return "keep";  // the keyword "labels" is the image
  if (option == "label-names") return "names";
  std::replace(option.begin(), option.end(), '-', '_');
  return option;
}

}  // namespace

std::string in_python_terms(const std::string& message) {
  static const std::regex kOption("(^|[^A-Za-z0-9_/.-])--([a-z]+(-[a-z]+)*)");
  const std::string told = message.substr(0, message.find("\nSee '"));
  std::string text;
  auto end_of_last = told.begin();
  for (std::sregex_iterator match(told.begin(), told.end(), kOption), none; match != none; ++match) {
    text.append(end_of_last, (*match)[0].first).append((*match)[1]).append(keyword_of((*match)[2]));
    end_of_last = (*match)[0].second;
  }
  return text.append(end_of_last, told.end());
}

}  // namespace podm::python
