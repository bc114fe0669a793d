#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::control {

/// Where a robot was, and the loudest cell that it heard there; none if it heard nothing.
struct HeardNote {
  base::Point position;
  std::optional<base::Point> loudest;
};

/// The square of 0.25 m in which a robot was and the loudest cell that it heard: notes that agree in both say the same.
struct HeardKey {
  explicit HeardKey(const HeardNote& note);

  bool operator==(const HeardKey& other) const;

  double column, row;
  bool hears;
  base::Point loudest;
  std::size_t hash;
};

/// What several robots hear, in an order; made once for all who take note of it.
class HeardNotes {
 public:
  explicit HeardNotes(std::vector<HeardNote> notes);

  const std::vector<HeardNote>& notes() const { return notes_; }
  const std::vector<HeardKey>& keys() const { return keys_; }

 private:
  std::vector<HeardNote> notes_;
  std::vector<HeardKey> keys_;
};

/// What is known of where victims are not.
///
/// A note rules out all places within `radius` [m] of its robot but the cell, of width `cell` [m], that it hears
/// loudest, and everything within `next_to` [m].
class RuledOut {
 public:
  RuledOut(double radius, double cell, double next_to);

  /// Forgets all notes.
  void Clear();

  /// Takes note; of notes that say the same, of the first.
  void Add(const HeardNote& note) { Add(note, HeardKey(note)); }
  void Add(const HeardNotes& heard);

  bool Covers(const base::Point& place) const;

 private:
  void Add(const HeardNote& note, const HeardKey& key);
  void Grow();
  std::size_t PlaceOf(const HeardKey& key) const;
  bool RulesOut(const HeardNote& note, const base::Point& place) const;
  std::int64_t BucketOf(double x, double y, int d_column, int d_row) const;

  double radius_, cell_, next_to_, bucket_;
  std::vector<HeardKey> known_;
  /// Where in `known_` a key is, counted from 1, at the place that its hash says or the next; 0: nowhere. Robots of a
  /// large team hear a hundred notes every second, and each keeps its own: a set of nodes took most of that time.
  std::vector<std::uint32_t> table_;
  std::unordered_map<std::int64_t, std::vector<HeardNote>> buckets_;
};

}  // namespace robotteamsim::control
