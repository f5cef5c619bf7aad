#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/uncertainty/result_indices.hpp"

namespace veridyn::numerics {
class BlockStore;
}

namespace veridyn::estimation {

/// A number of a simulation that varies evenly between two bounds.
struct IndexInput {
  std::string name;
  std::string unit = "1";
  double nominal = 0.0;
  double low = 0.0, high = 1.0;
  std::string place = {};  ///< "study.toml:14: sensitivity.input", for messages
};

/// What varies, as a study has it. Keys of the table `[sensitivity]`.
struct GivenInputs {
  /// One `[[sensitivity.input]]`.
  struct Input {
    std::string parameter;
    double range = 0.0;               ///< 0: that of all
    StudyTable table = StudyTable();  ///< may have `low` and `high`, in the unit of the parameter
  };
  double range = 0.1;  ///< share of the nominal value
  std::vector<Input> inputs = {};
  StudyTable table = StudyTable();

  [[nodiscard]] static const KeyTable<GivenInputs>& keys();
};

/// @param known     what may vary: name, unit and nominal value
/// @param defaults  of these, those that vary where the study names none
/// @throws InputError with file, line and key: a name that is not known, with the nearest; one that comes twice; bounds
/// that cross; a range of nothing.
[[nodiscard]] std::vector<IndexInput> index_inputs(const GivenInputs& given, std::span<const IndexInput> known,
                                                   std::span<const std::string> defaults);

/// One number that a simulation gives.
struct Response {
  std::string name;
  std::string unit = "1";
  double nominal = 0.0;     ///< with all inputs at their nominal values
  double negligible = 0.0;  ///< what differs by less over all points is rounding
};

/// A simulation as a function of its inputs.
struct ResponseProblem {
  std::vector<IndexInput> inputs;
  std::vector<Response> responses;
  /// Fills the responses at a point, in the inputs' order and units; NaN for one that the run does not show. False: the
  /// run could not finish. Called on any thread; must not throw.
  std::function<bool(const Eigen::VectorXd& point, std::span<double> responses)> run;
  std::uint64_t fingerprint = 0;  ///< of everything else that the responses follow from
};

/// Which input moves which response.
struct ResponseIndices {
  std::vector<IndexInput> inputs;
  std::vector<Response> responses = {};     ///< that depend on the inputs
  std::vector<ResultIndices> results = {};  ///< of these, in their order
  std::vector<std::string> constant = {};   ///< names of responses that no input moves
  std::size_t runs = 0;
  std::size_t failed = 0;  ///< runs that could not finish
  double seconds = 0.0;
  double processor_seconds = 0.0;  ///< of all threads, processes and earlier runs
  std::vector<std::string> warnings = {};
  bool completed = true;  ///< false: the progress asked to stop, or blocks of other processes are missing

  /// Index of the input with the greatest total order (mu* of Morris) of a result; none without indices.
  [[nodiscard]] std::optional<std::size_t> strongest(std::size_t result) const;
  [[nodiscard]] std::vector<std::string> input_names() const;
};

/// Runs the simulation at the points of a design over all inputs at once and decomposes the variance of each response
/// (`result_indices`). Runs that cannot finish are counted and their samples left out. The same bits on any number of
/// threads, and with any share of the store's blocks.
/// @param store  its batch is called "indices"
[[nodiscard]] ResponseIndices response_indices(const ResponseProblem& problem, const IndexOptions& options,
                                               numerics::BlockStore& store, Progress& progress);

}  // namespace veridyn::estimation
