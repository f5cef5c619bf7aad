#include "veridyn/report/document/html.hpp"

#include <array>
#include <string_view>
#include <utility>

#include "veridyn/core/assert.hpp"
#include "veridyn/report/document/page.hpp"
#include "veridyn/report/document/static_html.hpp"

namespace veridyn::report {

std::string to_html(Document all, const JsonOptions& options) {
  const Document document = with_captions_once(std::move(all));
  const std::string_view page = internal::page();
  const std::string_view note = internal::page_has_figures()
                                    ? "The picture appears when the page may run its script."
                                    : "The picture needs the front end; this program was built without it.";
  // In the order in which they stand in the page: what is filled in is never searched for markers.
  const std::array<std::pair<std::string_view, std::string>, 3> parts = {{
      {"@@VERIDYN_TITLE@@", escape_html(document.title)},
      {"@@VERIDYN_STATIC@@", static_html(document, note)},
      {"@@VERIDYN_DOCUMENT@@", internal::page_has_figures() ? to_json(document, options) : std::string()},
  }};
  std::string html;
  std::size_t from = 0;
  for (const auto& [marker, content] : parts) {
    const std::size_t at = page.find(marker, from);
    VERIDYN_ASSERT(at != std::string_view::npos);
    html += page.substr(from, at - from);
    html += content;
    from = at + marker.size();
  }
  html += page.substr(from);
  return html;
}

}  // namespace veridyn::report
