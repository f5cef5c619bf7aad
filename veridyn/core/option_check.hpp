#pragma once

#include <string>
#include <string_view>

namespace veridyn {

/// Refuses options that break their rules, in one form: "GROUP.OPTION: is VALUE; must be RULE".
class OptionCheck {
 public:
  /// @param group  under which the options stand, as `change_detection`
  explicit OptionCheck(std::string_view group) : group_(group) {}

  /// @throws InputError unless `holds`; `value` is printed, `rule` follows "must be"
  void operator()(bool holds, std::string_view option, double value, std::string_view rule) const;

 private:
  std::string group_;
};

}  // namespace veridyn
