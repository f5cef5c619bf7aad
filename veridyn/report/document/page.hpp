#pragma once

#include <string_view>

/// The page that a document is put into: the front end's bundle, embedded at build time, or the plain one.
namespace veridyn::report::internal {

/// HTML with the markers @@VERIDYN_TITLE@@, @@VERIDYN_STATIC@@ and @@VERIDYN_DOCUMENT@@, once each, in this order.
[[nodiscard]] std::string_view page();

/// Whether the page draws figures.
[[nodiscard]] bool page_has_figures();

}  // namespace veridyn::report::internal
