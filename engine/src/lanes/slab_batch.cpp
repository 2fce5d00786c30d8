#include "lanes/slab_batch.h"

#include <bit>

#include "lanes/lane_vectors.h"

namespace lumbrical {
namespace {

template <std::size_t N>
void write_contact(const SlabResults<N>& results, std::size_t k, Vec3 origin, Contact& contact) {
  contact.area = results.area[k];
  contact.volume = results.volume[k];
  contact.depth = results.depth[k];
  contact.error = 0;
  contact.normal = vector_at(results.normal, k);
  contact.centroid = origin + vector_at(results.centroid, k);
  contact.centre = origin + vector_at(results.centre, k);
}

// Pair k with the faces that cut it, as one more lane.
void add_rim(const SlabTerms& pairs, std::size_t k, RimTerms& rims) {
  const std::size_t lane = rims.count++;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    rims.a[axis][lane] = pairs.a[axis][k];
    rims.ab[axis][lane] = pairs.ab[axis][k];
    rims.ac[axis][lane] = pairs.ac[axis][k];
  }
  std::uint32_t cuts = 0;
  for (auto faces = static_cast<std::uint32_t>(pairs.cut[k]); faces != 0; faces &= faces - 1) {
    const auto face = static_cast<std::size_t>(std::countr_zero(faces));
    put_vector(vector_of(pairs.faces.normal[face]), lane, rims.cut_normal[cuts]);
    rims.cut_offset[cuts++][lane] = pairs.faces.offset[face];
  }
  rims.cut_count[lane] = cuts;
}

// A cut that takes nothing away, for lanes with fewer cuts than their neighbours.
void add_empty_cuts(RimTerms& rims) {
  for (std::size_t lane = 0; lane < rims.count; ++lane) {
    for (std::size_t cut = rims.cut_count[lane]; cut < rims.cut_count[lane | (kWholeRegisters - 1)]; ++cut) {
      put_vector({}, lane, rims.cut_normal[cut]);
      rims.cut_offset[cut][lane] = 0;
    }
  }
}

// Computes pairs `rim`, of which those with few cuts come first; appends those it leaves.
void finish_rims(std::span<const std::uint32_t> rim, SlabBatch& batch, std::size_t& left) {
  RimTerms& rims = batch.rims;
  rims.count = 0;
  rims.faces = &batch.pairs.faces;
  for (const std::uint32_t k : rim) add_rim(batch.pairs, k, rims);
  while (rims.count % kWholeRegisters != 0) add_rim(batch.pairs, rim.back(), rims);
  add_empty_cuts(rims);
  batch.kernels.slab_rims(rims);
  for (std::size_t lane = 0; lane < rim.size(); ++lane) {
    Contact& contact = *batch.contact[rim[lane]];
    contact.area = 0;
    if (rims.status[lane] == kSlabOpen) batch.left[left++] = &contact;
    if (rims.status[lane] == kSlabTouched) write_contact(rims, lane, batch.origin, contact);
  }
}

}  // namespace

void begin_batch(const Slab& slab, SlabBatch& batch) {
  batch.origin = slab.face[1].point;
  SlabFaces& faces = batch.pairs.faces;
  faces.count = slab.face_count;
  faces.tiny = Slab::kInPlane * slab.thickness;
  for (std::size_t i = 0; i < static_cast<std::size_t>(slab.face_count); ++i) {
    put_vector(slab.face[i].normal, faces.normal[i]);
    faces.offset[i] = dot(slab.face[i].normal, slab.face[i].point - batch.origin);
  }
  batch.pairs.count = 0;
}

void add_to_batch(const Corners& at, Contact& contact, SlabBatch& batch) {
  const std::size_t k = batch.pairs.count++;
  put_vector(at.a - batch.origin, k, batch.pairs.a);
  put_vector(at.b - at.a, k, batch.pairs.ab);
  put_vector(at.c - at.a, k, batch.pairs.ac);
  batch.contact[k] = &contact;
}

std::span<Contact* const> finish_batch(SlabBatch& batch) {
  SlabTerms& pairs = batch.pairs;
  if (pairs.count == 0) return {};
  for (auto* corner : {&pairs.a, &pairs.ab, &pairs.ac}) fill_up_vector(*corner, pairs.count);
  batch.kernels.slab_contacts(pairs);

  std::array<std::array<std::uint32_t, SlabTerms::kCapacity>, RimTerms::kMostCuts + 1> by_cuts;
  std::array<std::size_t, RimTerms::kMostCuts + 1> count{};
  std::size_t left = 0;
  for (std::size_t k = 0; k < pairs.count; ++k) {
    Contact& contact = *batch.contact[k];
    contact.area = 0;
    if (pairs.status[k] == kSlabTouched) write_contact(pairs, k, batch.origin, contact);
    if (pairs.status[k] != kSlabOpen) continue;
    const int cuts = std::popcount(static_cast<std::uint32_t>(pairs.cut[k]));
    if (cuts > static_cast<int>(RimTerms::kMostCuts)) {
      batch.left[left++] = &contact;
    } else {
      const auto row = static_cast<std::size_t>(cuts);
      by_cuts[row][count[row]++] = static_cast<std::uint32_t>(k);
    }
  }
  std::array<std::uint32_t, RimTerms::kCapacity> rim;
  std::size_t rim_count = 0;
  for (std::size_t cuts = 0; cuts < by_cuts.size(); ++cuts) {
    for (std::size_t i = 0; i < count[cuts]; ++i) {
      rim[rim_count++] = by_cuts[cuts][i];
      if (rim_count < rim.size()) continue;
      finish_rims(rim, batch, left);
      rim_count = 0;
    }
  }
  if (rim_count > 0) finish_rims(std::span(rim).first(rim_count), batch, left);
  pairs.count = 0;
  return {batch.left.data(), left};
}

}  // namespace lumbrical
