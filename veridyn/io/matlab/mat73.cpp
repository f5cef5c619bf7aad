#include <matio.h>

#include <cstdint>
#include <memory>

#include "veridyn/core/error.hpp"
#include "veridyn/io/matlab/mat_value.hpp"

namespace veridyn::io {
namespace {

template <typename T>
void copy(const matvar_t& from, std::size_t count, std::vector<double>& to) {
  const T* const values = static_cast<const T*>(from.data);
  to.assign(values, values + count);
}

// Not const only because matio asks for the number of fields through a plain pointer.
MatValue convert(matvar_t& from, int depth) {
  MatValue value;
  if (from.name != nullptr) value.name = internal::printable(from.name);
  std::size_t count = from.rank > 0 ? 1 : 0;
  for (int i = 0; i < from.rank; ++i) {
    value.extents.push_back(from.dims[i]);
    count *= from.dims[i];
  }
  if (depth > kDeepestMatNesting) return value;
  if (from.class_type == MAT_C_CELL || from.class_type == MAT_C_STRUCT) {
    const bool cell = from.class_type == MAT_C_CELL;
    value.kind = cell ? MatValue::Kind::kCell : MatValue::Kind::kStruct;
    const std::size_t fields = cell ? 1 : Mat_VarGetNumberOfFields(&from);
    auto* const* items = static_cast<matvar_t* const*>(from.data);
    for (std::size_t i = 0; items != nullptr && i < count * fields; ++i) {
      value.items.push_back(items[i] != nullptr ? convert(*items[i], depth + 1) : MatValue{});
    }
    return value;
  }
  const auto width = static_cast<std::size_t>(from.data_size > 0 ? from.data_size : 0);
  if (from.isComplex != 0 || from.data == nullptr || width == 0 || from.nbytes / width < count) return value;
  if (from.class_type == MAT_C_CHAR) {
    value.kind = MatValue::Kind::kText;
    for (std::size_t i = 0; i < count; ++i) {
      const unsigned code = width == 2 ? static_cast<const std::uint16_t*>(from.data)[i]
                                       : static_cast<const std::uint8_t*>(from.data)[i * width];
      value.text += code < 127 ? static_cast<char>(code) : '?';
    }
    value.text = internal::printable(value.text);
    return value;
  }
  value.kind = MatValue::Kind::kNumbers;
  switch (from.data_type) {
    case MAT_T_DOUBLE:
      copy<double>(from, count, value.numbers);
      break;
    case MAT_T_SINGLE:
      copy<float>(from, count, value.numbers);
      break;
    case MAT_T_INT8:
      copy<std::int8_t>(from, count, value.numbers);
      break;
    case MAT_T_UINT8:
      copy<std::uint8_t>(from, count, value.numbers);
      break;
    case MAT_T_INT16:
      copy<std::int16_t>(from, count, value.numbers);
      break;
    case MAT_T_UINT16:
      copy<std::uint16_t>(from, count, value.numbers);
      break;
    case MAT_T_INT32:
      copy<std::int32_t>(from, count, value.numbers);
      break;
    case MAT_T_UINT32:
      copy<std::uint32_t>(from, count, value.numbers);
      break;
    case MAT_T_INT64:
      copy<std::int64_t>(from, count, value.numbers);
      break;
    case MAT_T_UINT64:
      copy<std::uint64_t>(from, count, value.numbers);
      break;
    default:
      value.kind = MatValue::Kind::kOther;
  }
  return value;
}

/// Bytes of a variable as doubles, before it is read.
double bytes_of(matvar_t& info, int depth) {
  double count = info.rank > 0 ? 1.0 : 0.0;
  for (int i = 0; i < info.rank; ++i) count *= static_cast<double>(info.dims[i]);
  if (info.class_type != MAT_C_CELL && info.class_type != MAT_C_STRUCT) return 8.0 * count;
  const std::size_t fields = info.class_type == MAT_C_CELL ? 1 : Mat_VarGetNumberOfFields(&info);
  auto* const* items = static_cast<matvar_t* const*>(info.data);
  double bytes = 0.0;
  for (std::size_t i = 0;
       items != nullptr && depth < kDeepestMatNesting && static_cast<double>(i) < count * static_cast<double>(fields);
       ++i)
    if (items[i] != nullptr) bytes += bytes_of(*items[i], depth + 1);
  return bytes;
}

}  // namespace

void read_mat73(const std::string& path, const std::function<void(MatValue&&)>& take, LogDamage& damage) {
  const std::unique_ptr<mat_t, int (*)(mat_t*)> file(Mat_Open(path.c_str(), MAT_ACC_RDONLY), &Mat_Close);
  if (file == nullptr) throw InputError(path, "cannot be opened as a MATLAB 7.3 (HDF5) file");
  MatBudget budget(path);
  while (matvar_t* const variable = Mat_VarReadNextInfo(file.get())) {
    const std::unique_ptr<matvar_t, void (*)(matvar_t*)> owner(variable, &Mat_VarFree);
    budget.take(bytes_of(*variable, 0), variable->name != nullptr ? internal::printable(variable->name) : "");
    if (Mat_VarReadDataAll(file.get(), variable) != 0) {
      ++damage.records_lost;
      continue;
    }
    MatValue value = convert(*variable, 0);
    if (value.kind == MatValue::Kind::kOther) ++damage.records_lost;
    take(std::move(value));
  }
}

}  // namespace veridyn::io
