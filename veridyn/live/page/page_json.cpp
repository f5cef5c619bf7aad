#include "veridyn/live/page/page_json.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "veridyn/io/results/json_text.hpp"

namespace veridyn::live {
namespace {

std::string_view name_of(PageControls controls) {
  switch (controls) {
    case PageControls::kAll:
      return "all";
    case PageControls::kStop:
      return "stop";
    case PageControls::kNone:
      break;
  }
  return "none";
}

std::string quoted(const std::string& text) { return io::json_text(nlohmann::json(text)); }

}  // namespace

std::string page_json(std::span<const ShownRun> runs, std::span<const std::string> work, PageControls controls,
                      std::uint64_t refused) {
  std::vector<std::string> shown;
  for (const ShownRun& r : runs)
    shown.push_back(fmt::format(R"({{"name":{},"trouble":{},"length":{:.3f},"grows":{},"kept":{},"status":{}}})",
                                quoted(r.name), quoted(r.trouble), r.length, r.grows, r.kept,
                                r.status.empty() ? "null" : r.status));
  return fmt::format(R"({{"runs":[{}],"work":[{}],"controls":"{}","refused":{}}})", fmt::join(shown, ","),
                     fmt::join(work, ","), name_of(controls), refused);
}

}  // namespace veridyn::live
