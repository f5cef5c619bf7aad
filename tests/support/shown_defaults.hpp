#pragma once

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "veridyn/core/study_keys.hpp"

namespace veridyn::test {

/// Every key says what it is for and stands once in its table, and a study takes every default that is shown.
inline void expect_defaults_read_back(const std::vector<StudyKeys>& tables) {
  for (const StudyKeys& table : tables) {
    SCOPED_TRACE(table.table);
    std::set<std::string> names;
    for (const StudyKey& key : table.keys) {
      SCOPED_TRACE(key.name);
      EXPECT_TRUE(names.insert(key.name).second);
      EXPECT_FALSE(key.says.empty());
      if (key.in_words || key.otherwise.empty()) continue;
      const Study study = Study::parse(key.name + " = " + key.otherwise + "\n", "shown.toml");
      EXPECT_TRUE(study.root().has(key.name));
      if (!key.unit.empty()) EXPECT_NO_THROW(static_cast<void>(study.root().numbers(key.name, key.unit)));
    }
  }
}

}  // namespace veridyn::test
