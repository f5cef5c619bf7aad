#include <matio.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "tests/io/matlab/small_mat_log.hpp"
#include "tests/io/support.hpp"
#include "veridyn/io/matlab/mat.hpp"

namespace veridyn::io {
namespace {

using testing::expect_small_mat;

/// The same variables as `small_mat`, written by matio.
void write_with_matio(const std::filesystem::path& path, mat_ft version, matio_compression compression) {
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, version);
  ASSERT_NE(file, nullptr);
  std::size_t column[2] = {3, 1};
  std::size_t one[2] = {1, 1};
  std::size_t text[2] = {1, 2};
  std::size_t table[2] = {2, 3};
  double time[] = {0.0, 0.02, 0.04};
  double p[] = {0.1, 0.2, 0.3};
  std::int16_t q[] = {-1, 0, 7};
  char note[] = "hi";
  double numbers[] = {1, 2, 3, 4, 5, 6};
  matvar_t* fields[] = {Mat_VarCreate("time", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, column, time, 0),
                        Mat_VarCreate("p", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, column, p, 0),
                        Mat_VarCreate("q", MAT_C_INT16, MAT_T_INT16, 2, column, q, 0),
                        Mat_VarCreate("note", MAT_C_CHAR, MAT_T_UINT8, 2, text, note, 0), nullptr};
  matvar_t* flight = Mat_VarCreate("flight", MAT_C_STRUCT, MAT_T_STRUCT, 2, one, fields, 0);
  matvar_t* array = Mat_VarCreate("table", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, table, numbers, 0);
  EXPECT_EQ(Mat_VarWrite(file, flight, compression), 0);
  EXPECT_EQ(Mat_VarWrite(file, array, compression), 0);
  Mat_VarFree(flight);
  Mat_VarFree(array);
  Mat_Close(file);
}

TEST(Mat, ReadsWhatMatioWritesInAllVersions) {
  const testing::TemporaryFolder folder;
  write_with_matio(folder.path() / "5.mat", MAT_FT_MAT5, MAT_COMPRESSION_NONE);
  expect_small_mat(read_mat_file(folder.path() / "5.mat"));
  write_with_matio(folder.path() / "7.mat", MAT_FT_MAT5, MAT_COMPRESSION_ZLIB);
  expect_small_mat(read_mat_file(folder.path() / "7.mat"));
  write_with_matio(folder.path() / "73.mat", MAT_FT_MAT73, MAT_COMPRESSION_NONE);
  expect_small_mat(read_mat_file(folder.path() / "73.mat"));
}

}  // namespace
}  // namespace veridyn::io
