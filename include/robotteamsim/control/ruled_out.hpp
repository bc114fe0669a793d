#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::control {

/// A robot's position and the loudest cell that it heard there; none if it heard nothing.
struct HeardNote {
  base::Point position;
  std::optional<base::Point> loudest;
};

/// The square of 0.25 m that a robot was in and the loudest cell that it heard: notes equal in both are duplicates.
struct HeardKey {
  explicit HeardKey(const HeardNote& note);

  bool operator==(const HeardKey& other) const;

  double column, row;
  bool hears;
  base::Point loudest;
  std::size_t hash;
};

/// Notes of several robots in a fixed order, computed once for all that receive them.
class HeardNotes {
 public:
  explicit HeardNotes(std::vector<HeardNote> notes);

  const std::vector<HeardNote>& notes() const { return notes_; }
  const std::vector<HeardKey>& keys() const { return keys_; }

 private:
  std::vector<HeardNote> notes_;
  std::vector<HeardKey> keys_;
};

/// The places where victims cannot be, as far as known.
///
/// A note rules out all places within `radius_m` of its robot except the loudest cell, of width `cell_m`, and
/// everything within `next_to_m`.
class RuledOut {
 public:
  RuledOut(double radius_m, double cell_m, double next_to_m);

  /// Forgets all notes.
  void Clear();

  /// Adds notes; of duplicates only the first.
  /// Throws std::invalid_argument if a place is not finite.
  void Add(const HeardNote& note);
  void Add(const HeardNotes& heard);

  bool Covers(const base::Point& place) const;

 private:
  void Add(const HeardNote& note, const HeardKey& key);
  void Grow();
  std::size_t PlaceOf(const HeardKey& key) const;
  std::size_t EmptyPlace(std::size_t hash) const;
  bool RulesOut(const HeardNote& note, const base::Point& place) const;
  std::int64_t BucketOf(double x, double y, int d_column, int d_row) const;

  double radius_m_, cell_m_, next_to_m_, bucket_m_;
  std::vector<HeardNote> notes_;
  std::vector<std::size_t> hashes_;  // of the keys of `notes_`
  /// A hash table with open addressing: indices in `notes_` plus 1; 0: empty. Robots of a large team add a hundred
  /// notes every second, and each has its own table: std::unordered_set took most of that time.
  std::vector<std::uint32_t> table_;
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> buckets_;  // indices in `notes_`
};

}  // namespace robotteamsim::control
