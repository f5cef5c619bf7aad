#pragma once

#include <algorithm>
#include <concepts>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn {

/// Values that a number of a study may have, in SI.
struct KeyRange {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool with_low = true, with_high = true;  ///< the ends themselves

  [[nodiscard]] bool contains(double x) const {
    return (with_low ? x >= low : x > low) && (with_high ? x <= high : x < high);
  }
  /// "> 0", "from 1 to 10", "between 0 and 90 deg", "above 0 and at most 1"; nothing for any number.
  [[nodiscard]] std::string text(std::string_view unit) const;
};
inline constexpr KeyRange kAnyNumber{};
inline constexpr KeyRange kPositive{.low = 0.0, .with_low = false};
inline constexpr KeyRange kNotNegative{.low = 0.0};
/// Both ends belong to it.
[[nodiscard]] constexpr KeyRange from_to(double low, double high) { return {.low = low, .high = high}; }
/// Neither end belongs to it.
[[nodiscard]] constexpr KeyRange between(double low, double high) {
  return {.low = low, .high = high, .with_low = false, .with_high = false};
}
/// Above 0, at most `most`.
[[nodiscard]] constexpr KeyRange share_up_to(double most) { return {.low = 0.0, .high = most, .with_low = false}; }

/// The largest seed: every whole number up to it is a number of its own in TOML and JSON.
inline constexpr long long kLargestSeed = 9007199254740992;

/// A key of a study as its user sees it.
struct StudyKey {
  std::string name;
  std::string unit;       ///< SI; empty for texts and switches
  std::string range;      ///< "> 0", "`auto`, `vane`"
  std::string otherwise;  ///< as one would write it in the study, "3 m/s"; a sentence where it depends on others
  std::string says;
  bool in_words = false;  ///< `otherwise` is a sentence and not what could be written
};

/// The keys of one table of a study.
struct StudyKeys {
  std::string table;  ///< "segments", "identify.uncertainty"
  std::string about;  ///< one sentence; empty where the keys say it
  std::vector<StudyKey> keys;
  bool repeated = false;  ///< `[[table]]`
};

/// "[segments]", "[[data.run]]".
[[nodiscard]] std::string heading_of(const StudyKeys& table);

/// The keys of tables as Markdown, one table each: key, unit, default, range, meaning.
[[nodiscard]] std::string in_markdown(const StudyKeys& keys);

/// `# name = default   # what it is for`, as a study to start from has it.
[[nodiscard]] std::string commented_line(const StudyKey& key);

/// A study to start from: each line `@keys TABLE KEY KEY ...` of the template becomes the commented lines of these
/// keys.
/// @throws std::logic_error for a table or key that `tables` does not have
[[nodiscard]] std::string with_keys(std::string_view study, const std::vector<StudyKeys>& tables);

/// `"a", "b"`, each with `mark` around it.
[[nodiscard]] std::string quoted_list(const std::vector<std::string>& texts, std::string_view mark = {});

/// Keys that a table must have and has not.
/// @throws InputError naming all of them, where there are any
void refuse_missing(const StudyTable& table, const std::vector<std::string>& keys);
/// Those of `keys` that a table has not, as above.
void require_keys(const StudyTable& table, std::initializer_list<const char*> keys);
/// Keys that have no place beside others. @throws InputError for the first that is there, saying `why`
void refuse_keys(const StudyTable& table, std::initializer_list<const char*> keys, std::string_view why);

namespace internal {

[[nodiscard]] std::string shown(double si, std::string_view unit);
[[nodiscard]] std::string shown(const std::vector<double>& si, std::string_view unit);
/// @throws InputError outside `range`
[[nodiscard]] double number_in(const StudyTable& table, const std::string& name, const std::string& unit,
                               const KeyRange& range);
/// `size` 0: any number of them. @throws InputError for another size, or outside `range`
[[nodiscard]] std::vector<double> numbers_in(const StudyTable& table, const std::string& name, const std::string& unit,
                                             const KeyRange& range, std::size_t size);
[[nodiscard]] long long integer_in(const StudyTable& table, const std::string& name, long long least, long long most);
/// Where the texts of a list are among `names`. @throws InputError for one that is not
[[nodiscard]] std::vector<std::size_t> chosen_in(const StudyTable& table, const std::string& name,
                                                 const std::vector<std::string>& names);

}  // namespace internal

/// The names of an enumeration with what they stand for, after those in `before`: values of a KeyTable::choice.
template <typename V, typename E, std::size_t N>
[[nodiscard]] std::vector<std::pair<std::string, V>> choices_of(const EnumArray<E, std::string_view, N>& names,
                                                                std::vector<std::pair<std::string, V>> before = {}) {
  for (const E e : enumerators<E, N>()) before.emplace_back(names[e], e);
  return before;
}

/// The keys of one table of a study that fill a `T`: read, documented and written to a study to start from by what
/// stands here once. A key that is missing leaves what `T` has. A field is a pointer to a member, or a function from
/// `T&` to a reference for what lies deeper.
///
/// What keys must be to each other is a `check`, after all are read.
template <typename T>
class KeyTable {
  template <typename Field>
  using ValueOf = std::remove_reference_t<std::invoke_result_t<const Field&, T&>>;

 public:
  /// @param table its name in the study, "segments"
  explicit KeyTable(std::string table, std::string about = {}) : table_(std::move(table)), about_(std::move(about)) {}

  /// Of a double, or an optional one; `unit` is the SI unit.
  template <typename Field>
  KeyTable& number(std::string name, Field field, std::string unit, KeyRange range, std::string says) {
    return add(
        {std::move(name), unit, range.text(unit), {}, std::move(says)},
        [field, unit](T& object) {
          const std::optional<double> value = std::invoke(field, object);
          return value ? internal::shown(*value, unit) : std::string();
        },
        [field, unit, range](const StudyTable& table, const std::string& key, T& object) {
          std::invoke(field, object) = internal::number_in(table, key, unit, range);
        });
  }

  /// Of whole numbers, or an optional one.
  template <typename Field>
  KeyTable& count(std::string name, Field field, long long least, long long most, std::string says) {
    using V = ValueOf<Field>;
    KeyRange range = from_to(static_cast<double>(least), static_cast<double>(most));
    if (most == std::numeric_limits<long long>::max()) range.high = std::numeric_limits<double>::infinity();
    return add(
        {std::move(name), {}, range.text({}), {}, std::move(says)},
        [field](T& object) {
          const auto value = std::optional(std::invoke(field, object));
          return value ? std::to_string(*value) : std::string();
        },
        [field, least, most](const StudyTable& table, const std::string& key, T& object) {
          const long long value = internal::integer_in(table, key, least, most);
          if constexpr (std::integral<V>)
            std::invoke(field, object) = static_cast<V>(value);
          else
            std::invoke(field, object) = static_cast<typename V::value_type>(value);
        });
  }

  /// Of several numbers: a `std::vector<double>` of any length, an array or fixed Eigen vector of its own.
  template <typename Field>
  KeyTable& numbers(std::string name, Field field, std::string unit, KeyRange range, std::string says) {
    return add(
        {std::move(name), unit, range.text(unit), {}, std::move(says)},
        [field, unit](T& object) {
          auto& v = std::invoke(field, object);
          return internal::shown(std::vector<double>(v.data(), v.data() + v.size()), unit);
        },
        [field, unit, range](const StudyTable& table, const std::string& key, T& object) {
          auto& v = std::invoke(field, object);
          if constexpr (std::same_as<ValueOf<Field>, std::vector<double>>) {
            v = internal::numbers_in(table, key, unit, range, 0);
          } else {
            const auto read = internal::numbers_in(table, key, unit, range, static_cast<std::size_t>(v.size()));
            std::copy(read.begin(), read.end(), v.data());
          }
        });
  }

  template <typename Field>
  KeyTable& flag(std::string name, Field field, std::string says) {
    return add(
        {std::move(name), {}, "`true`, `false`", {}, std::move(says)},
        [field](T& object) { return std::invoke(field, object) ? "true" : "false"; },
        [field](const StudyTable& table, const std::string& key, T& object) {
          std::invoke(field, object) = table.flag_or(key, false);
        });
  }

  template <typename Field>
  KeyTable& text(std::string name, Field field, std::string says) {
    return add(
        {std::move(name), {}, {}, {}, std::move(says)},
        [field](T& object) {
          const std::string now = std::invoke(field, object);
          return now.empty() ? now : quoted_list({now});
        },
        [field](const StudyTable& table, const std::string& key, T& object) {
          std::invoke(field, object) = table.text(key);
        });
  }

  /// A list of texts; one text counts as a list of one.
  template <typename Field>
  KeyTable& texts(std::string name, Field field, std::string says) {
    return add(
        {std::move(name), {}, {}, {}, std::move(says)},
        [field](T& object) { return '[' + quoted_list(std::invoke(field, object)) + ']'; },
        [field](const StudyTable& table, const std::string& key, T& object) {
          std::invoke(field, object) = table.texts(key);
        });
  }

  /// A path, or an optional one; see StudyTable::file.
  template <typename Field>
  KeyTable& file(std::string name, Field field, std::string says) {
    return add(
        {std::move(name), {}, "a file", {}, std::move(says)}, [](T&) { return std::string(); },
        [field](const StudyTable& table, const std::string& key, T& object) {
          std::invoke(field, object) = table.file(key);
        });
  }

  /// Several paths; one counts as a list of one.
  template <typename Field>
  KeyTable& files(std::string name, Field field, std::string says) {
    return add(
        {std::move(name), {}, "files", {}, std::move(says)}, [](T&) { return std::string(); },
        [field](const StudyTable& table, const std::string& key, T& object) {
          std::invoke(field, object) = table.files(key);
        });
  }

  /// One of several names, each of which stands for a value of the field.
  template <typename Field>
  KeyTable& choice(std::string name, Field field,
                   std::vector<std::pair<std::string, std::type_identity_t<ValueOf<Field>>>> values, std::string says) {
    std::vector<std::string> names;
    for (const auto& [text, value] : values) names.push_back(text);
    return add(
        {std::move(name), {}, quoted_list(names, "`"), {}, std::move(says)},
        [field, values](T& object) {
          for (const auto& [text, value] : values)
            if (value == std::invoke(field, object)) return quoted_list({text});
          return std::string();
        },
        [field, names, values](const StudyTable& table, const std::string& key, T& object) {
          const std::string chosen = table.choice_or(key, names, "");
          for (const auto& [text, value] : values)
            if (text == chosen) std::invoke(field, object) = value;
        });
  }

  /// A list of such names, of which the field has the values in the order of the study.
  template <typename Field>
  KeyTable& choices(std::string name, Field field,
                    std::vector<std::pair<std::string, typename ValueOf<Field>::value_type>> values, std::string says) {
    std::vector<std::string> names;
    for (const auto& [text, value] : values) names.push_back(text);
    return add(
        {std::move(name), {}, "a list of " + quoted_list(names, "`"), {}, std::move(says)},
        [field, values](T& object) {
          std::vector<std::string> now;
          for (const auto& one : std::invoke(field, object))
            for (const auto& [text, value] : values)
              if (value == one) now.push_back(text);
          return '[' + quoted_list(now) + ']';
        },
        [field, names, values](const StudyTable& table, const std::string& key, T& object) {
          std::invoke(field, object).clear();
          for (const std::size_t i : internal::chosen_in(table, key, names))
            std::invoke(field, object).push_back(values[i].second);
        });
  }

  /// A list of names, each of which makes a flag `value`.
  KeyTable& flags(std::string name, std::vector<std::pair<std::string, bool T::*>> flags, bool value,
                  std::string says) {
    std::vector<std::string> names;
    for (const auto& [text, member] : flags) names.push_back(text);
    return add(
        {std::move(name), {}, "a list of " + quoted_list(names, "`"), {}, std::move(says)},
        [flags, value](T& object) {
          std::vector<std::string> now;
          for (const auto& [text, member] : flags)
            if (object.*member == value) now.push_back(text);
          return '[' + quoted_list(now) + ']';
        },
        [flags, names, value](const StudyTable& table, const std::string& key, T& object) {
          for (const auto& [text, member] : flags) object.*member = !value;
          for (const std::size_t i : internal::chosen_in(table, key, names)) object.*flags[i].second = value;
        });
  }

  /// What is read by hand: tables within, lists of names with checks of their own. `take` is called only where the
  /// key is there. `key.otherwise` is what stands in the study that leaves it out.
  KeyTable& other(StudyKey key, std::function<void(const StudyTable&, const std::string&, T&)> take) {
    return add(
        key, [otherwise = key.otherwise](T&) { return otherwise; }, std::move(take));
  }

  /// What is read where more is known than this table: the unit of a coordinate, the names of a model.
  KeyTable& elsewhere(StudyKey key) {
    return other(std::move(key), [](const StudyTable&, const std::string&, T&) {});
  }

  /// In the same table, the keys of its base.
  template <typename Base>
  requires std::derived_from<T, Base> KeyTable& with(const KeyTable<Base>& base) {
    return with([](T& object) -> Base& { return object; }, base);
  }
  /// In the same table, the keys of a part.
  template <typename Field, typename Part>
  KeyTable& with(Field field, const KeyTable<Part>& part) {
    for (const auto& entry : part.entries_)
      entries_.push_back({entry.key,
                          [field, shown = entry.shown](T& object) { return shown(std::invoke(field, object)); },
                          [field, take = entry.take](const StudyTable& table, const std::string& key, T& object) {
                            take(table, key, std::invoke(field, object));
                          },
                          entry.old_name, entry.required});
    for (const auto& inner : part.within_)
      within_.push_back({[field, describe = inner.describe](std::vector<StudyKeys>& all, T& object) {
                           describe(all, std::invoke(field, object));
                         },
                         [field, take = inner.take](const StudyTable& table, T& object) {
                           take(table, std::invoke(field, object));
                         }});
    for (const auto& rule : part.checks_)
      checks_.push_back([field, rule](const StudyTable& table, T& object) { rule(table, std::invoke(field, object)); });
    return *this;
  }
  /// A table within, `[table.name]`, with keys of its own.
  template <typename Field, typename Part>
  KeyTable& table(const std::string& name, Field field, const KeyTable<Part>& part) {
    return add_within(
        name, part.table_, [part, field](T& object) { return part.described(std::invoke(field, object)); },
        [part, field, name](const StudyTable& outer, T& object) {
          part.read(outer.table_or_empty(name), std::invoke(field, object));
        });
  }
  /// The same where it is the field's value as a whole: what it leaves out has its default, whatever the field had.
  template <typename Field, typename Part>
  KeyTable& whole_table(const std::string& name, Field field, const KeyTable<Part>& part) {
    return within(name, part, [part, field, name](const StudyTable& outer, T& object) {
      if (outer.has(name)) std::invoke(field, object) = part.read(outer.table(name));
    });
  }
  /// An array of tables within, `[[table.name]]`; `take` is called for each.
  template <typename Part>
  KeyTable& tables(const std::string& name, const KeyTable<Part>& part,
                   std::function<void(const StudyTable&, T&)> take) {
    return within(
        name, part,
        [name, take = std::move(take)](const StudyTable& outer, T& object) {
          for (const StudyTable& one : outer.tables(name)) take(one, object);
        },
        true);
  }
  /// A table within that is read by hand: `take` gets this table and the object.
  template <typename Part>
  KeyTable& within(const std::string& name, const KeyTable<Part>& part, std::function<void(const StudyTable&, T&)> take,
                   bool repeated = false) {
    return add_within(
        name, part.table_, [part](T&) { return part.described(); }, std::move(take), repeated);
  }

  /// The study may have several of it, `[[table]]`.
  KeyTable& repeated() {
    repeated_ = true;
    return *this;
  }

  /// `rule` throws where what was read does not go together.
  KeyTable& check(std::function<void(const StudyTable&, T&)> rule) {
    checks_.push_back(std::move(rule));
    return *this;
  }

  /// Of the key named last: its default in words, where it depends on other things.
  KeyTable& otherwise(const std::string& words) {
    entries_.back().key.otherwise = words;
    entries_.back().key.in_words = true;
    return *this;
  }
  /// Of the key named last: what it was called in earlier versions.
  KeyTable& was(const std::string& old_name) {
    entries_.back().old_name = old_name;
    return *this;
  }
  /// Of the key named last: a study must have it.
  KeyTable& required() {
    entries_.back().required = true;
    return otherwise("required");
  }

  /// Takes the keys that are there.
  /// @throws InputError with file, line and key; naming all that are required and missing
  void read(const StudyTable& table, T& object) const {
    std::vector<std::string> missing;
    for (const Entry& entry : entries_) {
      std::string name = entry.key.name;
      if (!entry.old_name.empty()) name = table.renamed(name, entry.old_name);
      if (table.has(name))
        entry.take(table, name, object);
      else if (entry.required)
        missing.push_back(name);
    }
    for (const Within& within : within_) within.take(table, object);
    refuse_missing(table, missing);
    for (const auto& rule : checks_) rule(table, object);
  }
  [[nodiscard]] T read(const StudyTable& table) const {
    T object{};
    read(table, object);
    return object;
  }

  /// This table and those within it, with the defaults of a `T`.
  [[nodiscard]] std::vector<StudyKeys> described() const {
    T defaults{};
    return described(defaults);
  }
  /// The same with those of an object.
  [[nodiscard]] std::vector<StudyKeys> described(T& defaults) const {
    std::vector<StudyKeys> all{{table_, about_, {}, repeated_}};
    for (const Entry& entry : entries_) {
      all.front().keys.push_back(entry.key);
      if (!entry.key.in_words) all.front().keys.back().otherwise = entry.shown(defaults);
    }
    for (const Within& within : within_) within.describe(all, defaults);
    return all;
  }

 private:
  template <typename U>
  friend class KeyTable;
  struct Entry {
    StudyKey key;
    std::function<std::string(T&)> shown;
    std::function<void(const StudyTable&, const std::string&, T&)> take;
    std::string old_name = {};
    bool required = false;
  };
  struct Within {
    std::function<void(std::vector<StudyKeys>&, T&)> describe;
    std::function<void(const StudyTable&, T&)> take;
  };

  KeyTable& add(StudyKey key, std::function<std::string(T&)> shown,
                std::function<void(const StudyTable&, const std::string&, T&)> take) {
    entries_.push_back({std::move(key), std::move(shown), std::move(take)});
    return *this;
  }

  /// `described`: the tables of the part, whose first is called `own`.
  KeyTable& add_within(const std::string& name, const std::string& own,
                       std::function<std::vector<StudyKeys>(T&)> described,
                       std::function<void(const StudyTable&, T&)> take, bool repeated = false) {
    within_.push_back({[own, described = std::move(described), repeated,
                        path = table_.empty() ? name : table_ + '.' + name](std::vector<StudyKeys>& all, T& object) {
                         for (StudyKeys& keys : described(object)) {
                           if (keys.keys.empty()) continue;
                           keys.table = path + keys.table.substr(own.size());
                           keys.repeated = keys.repeated || (repeated && keys.table == path);
                           all.push_back(std::move(keys));
                         }
                       },
                       std::move(take)});
    return *this;
  }

  std::string table_, about_;
  bool repeated_ = false;
  std::vector<Entry> entries_;
  std::vector<Within> within_;
  std::vector<std::function<void(const StudyTable&, T&)>> checks_;
};

/// The tables of several, with those within them.
template <typename... T>
[[nodiscard]] std::vector<StudyKeys> all_of(const KeyTable<T>&... tables) {
  std::vector<StudyKeys> all;
  const auto add = [&all](std::vector<StudyKeys> more) { all.insert(all.end(), more.begin(), more.end()); };
  (add(tables.described()), ...);
  return all;
}

}  // namespace veridyn
