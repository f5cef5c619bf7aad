#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace veridyn::io {

/// Stamps in order, and which of the original rows they belong to.
struct OrderedStamps {
  std::vector<double> time;        ///< [s], never decreases
  std::vector<std::uint64_t> row;  ///< original row of each stamp; empty when all rows stay where they are
  std::size_t spikes = 0;          ///< rows dropped
  std::size_t reordered = 0;       ///< rows with a stamp before that of an earlier row
  std::size_t doubled = 0;         ///< rows with the stamp of the row before
};

/// Puts the stamps [s] of one topic, given in the order of the file, into order.
///
/// A row is dropped as a spike when its stamp is not finite, or lies further than `max(1 s, 20 median intervals)` from
/// the median of the nine rows around it; up to four bad rows in a row are found this way. The median of a sequence
/// that never decreases is its middle, so gaps, however long, are never mistaken for spikes. What is left out of order
/// is sorted; equal stamps keep the order of the file. Linear time where the stamps are in order already.
[[nodiscard]] OrderedStamps order_stamps(std::vector<double> stamps);

}  // namespace veridyn::io
