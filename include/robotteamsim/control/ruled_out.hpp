#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <utility>
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

/// The notes of one robot or more, in the order in which they came, without duplicates.
class NoteLog {
 public:
  explicit NoteLog(double bucket_m);
  /// The first notes of another one.
  NoteLog(const NoteLog& other, std::size_t length);

  std::uint64_t id() const { return id_; }
  std::size_t size() const { return notes_.size(); }

  /// Adds a note, unless it is a duplicate.
  void Add(const HeardNote& note, const HeardKey& key);

  /// Whether a note with this key is among the first ones.
  bool Has(const HeardKey& key, std::size_t length) const;

  /// Calls a function with each of the first notes near a place, until it returns true; returns whether it did.
  template <typename Function>
  bool AnyNear(const base::Point& place, std::size_t length, Function function) const {
    for (const int d_column : {-1, 0, 1}) {
      for (const int d_row : {-1, 0, 1}) {
        const auto bucket = buckets_.find(BucketOf(place.x, place.y, d_column, d_row));
        if (bucket == buckets_.end()) continue;
        for (const std::uint32_t index : bucket->second) {
          if (index >= length) break;
          if (function(notes_[index])) return true;
        }
      }
    }
    return false;
  }

 private:
  void Grow();
  std::size_t PlaceOf(const HeardKey& key) const;
  std::size_t EmptyPlace(std::size_t hash) const;
  std::int64_t BucketOf(double x, double y, int d_column, int d_row) const;

  std::uint64_t id_;
  double bucket_m_;
  std::vector<HeardNote> notes_;
  std::vector<std::size_t> hashes_;  // of the keys of `notes_`
  /// A hash table with open addressing: indices in `notes_` plus 1; 0: empty. std::unordered_set took most of the time.
  std::vector<std::uint32_t> table_;
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> buckets_;  // indices in `notes_`
};

/// Notes of several robots in a fixed order, computed once for all that receive them.
class HeardNotes {
 public:
  explicit HeardNotes(std::vector<HeardNote> notes);

  const std::vector<HeardNote>& notes() const { return notes_; }
  const std::vector<HeardKey>& keys() const { return keys_; }

 private:
  friend class RuledOut;

  std::vector<HeardNote> notes_;
  std::vector<HeardKey> keys_;
  /// What those have who received these notes: by their log before, its length, and the size of its buckets.
  std::map<std::tuple<std::uint64_t, std::size_t, double>, std::pair<std::weak_ptr<NoteLog>, std::size_t>> received_;
};

/// The places where victims cannot be, as far as known.
///
/// A note rules out all places within `radius_m` of its robot except the loudest cell, of width `cell_m`, and
/// everything within `next_to_m`. Robots that have received the same notes share one log of them, each its beginning: a
/// robot of a large team would otherwise add a hundred notes every second to a table of its own.
class RuledOut {
 public:
  RuledOut(double radius_m, double cell_m, double next_to_m);

  /// Forgets all notes.
  void Clear();

  /// Adds a note of the robot itself, unless it is a duplicate. Throws std::invalid_argument if a place is not finite.
  void Add(const HeardNote& note);

  /// Adds notes of a team, of duplicates only the first. If a note of the robot itself is among them, it has the place
  /// that it has there.
  void Add(HeardNotes* heard);

  bool Covers(const base::Point& place) const;

 private:
  void AddOwn();
  NoteLog& Continued();
  bool RulesOut(const HeardNote& note, const base::Point& place) const;

  double radius_m_, cell_m_, next_to_m_, bucket_m_;
  std::shared_ptr<NoteLog> log_;                       ///< none: no notes
  std::size_t length_ = 0;                             ///< of the beginning of the log that this robot knows
  std::optional<std::pair<HeardNote, HeardKey>> own_;  ///< the last note of the robot itself, if it is not in the log
};

}  // namespace robotteamsim::control
