#include "tests/apps/program.hpp"

namespace veridyn {
namespace {

class Regress : public ProgramTest {};

/// Longley's data as in NIST's Statistical Reference Datasets (StRD, linear regression, "Longley").
constexpr const char* kLongley =
    "y,x1,x2,x3,x4,x5,x6\n"
    "60323,83.0,234289,2356,1590,107608,1947\n61122,88.5,259426,2325,1456,108632,1948\n"
    "60171,88.2,258054,3682,1616,109773,1949\n61187,89.5,284599,3351,1650,110929,1950\n"
    "63221,96.2,328975,2099,3099,112075,1951\n63639,98.1,346999,1932,3594,113270,1952\n"
    "64989,99.0,365385,1870,3547,115094,1953\n63761,100.0,363112,3578,3350,116219,1954\n"
    "66019,101.2,397469,2904,3048,117388,1955\n67857,104.6,419180,2822,2857,118734,1956\n"
    "68169,108.4,442769,2936,2798,120445,1957\n66513,110.8,444546,4681,2637,121950,1958\n"
    "68655,112.6,482704,3813,2552,123366,1959\n69564,114.2,502601,3931,2514,125368,1960\n"
    "69331,115.7,518173,4806,2572,127852,1961\n70551,116.9,554894,4007,2827,130081,1962\n";

// Certified: -3482258.63459582, 15.0618722713733, ..., 1829.15146461355; residual standard deviation 304.854073561965.
TEST_F(Regress, FindsTheCertifiedValuesOfLongleyAndSaysThatTheyAreCollinear) {
  const std::string table = (folder_ / "longley.csv").string(), out = (folder_ / "out").string();
  write_file(table, kLongley);
  const Outcome outcome = run("regress " + table + " --response y --method OLS --json --quiet --out " + out);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  for (const char* certified : {"-3482258.634", "15.0618722", "1829.15146"})
    EXPECT_THAT(outcome.text, testing::HasSubstr(certified));
  const std::string json = read_file(out + "/estimate.json");
  EXPECT_THAT(json, testing::HasSubstr("304.85407"));
  EXPECT_THAT(json, testing::HasSubstr("combinations of each other"));
  for (const char* file : {"report.html", "parameters.csv", "methods.csv", "rows.csv", "run.json"})
    EXPECT_TRUE(std::filesystem::exists(out + "/" + file)) << file;
}

TEST_F(Regress, NamesWhatIsWrong) {
  const std::string table = (folder_ / "t.csv").string();
  write_file(table, "z,a,run\n1,2,x\n2,3,x\n3,5,y\n");
  const std::string out = " --out " + (folder_ / "o").string();
  const auto refusal = [&](const std::string& words) {
    const Outcome outcome = run("regress " + table + " " + words + out);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
    return outcome.text;
  };
  EXPECT_THAT(refusal("--response y"), testing::HasSubstr("has no column 'y'"));
  EXPECT_THAT(refusal("--response z --regressors a,run"), testing::HasSubstr("column 'run' holds text"));
  EXPECT_THAT(refusal("--response z --regressors z"), testing::HasSubstr("holds the response"));
  EXPECT_THAT(refusal("--response z --noise b=1"), testing::HasSubstr("--noise"));
}

}  // namespace
}  // namespace veridyn
