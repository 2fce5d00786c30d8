#include "exact/slab_pairs.h"

#include <bit>

#include "exact/through_lanes.h"
#include "section/slab.h"

namespace lumbrical {
namespace {

// A pair and the faces that cut it, a bit each.
struct RimPair {
  std::uint32_t slot;
  std::uint32_t faces;
};
std::size_t cut_count(const RimPair& pair) { return static_cast<std::size_t>(std::popcount(pair.faces)); }

// Points are seen from here: the same for both slabs, so that they share the core's plane to the last bit.
Vec3 origin_of(const Slab& slab) { return slab.face[1].point; }

SlabFaces faces_of(const Slab& slab) {
  SlabFaces faces;
  faces.count = slab.face_count;
  faces.near = kAlongCut * slab.thickness;
  for (std::size_t i = 0; i < slab.face_count; ++i) {
    put_vector(slab.face[i].normal, faces.normal[i]);
    faces.offset[i] = dot(slab.face[i].normal, slab.face[i].point - origin_of(slab));
  }
  return faces;
}

template <class Terms>
void put_triangle(const Corners& at, Vec3 origin, std::size_t k, Terms& terms) {
  put_vector(at.a - origin, k, terms.a);
  put_vector(at.b - at.a, k, terms.ab);
  put_vector(at.c - at.a, k, terms.ac);
}

void put_cuts(const SlabFaces& faces, std::uint32_t cuts, std::size_t k, RimTerms& terms) {
  for (std::size_t i = 0; cuts != 0; ++i, cuts &= cuts - 1) {
    const auto face = static_cast<std::size_t>(std::countr_zero(cuts));
    put_vector(vector_of(faces.normal[face]), k, terms.cut_normal[i]);
    terms.cut_offset[i][k] = faces.offset[face];
  }
}

template <std::size_t N>
void read_contact(const SlabResults<N>& results, std::size_t k, const Slab& slab, const Corners& at,
                  Contact& contact) {
  const Vec3 origin = origin_of(slab);
  contact.area = results.area[k];
  contact.volume = results.volume[k];
  contact.depth = results.depth[k];
  contact.error = slab_error(slab, at, contact.area);
  contact.normal = vector_at(results.normal, k);
  contact.centroid = origin + vector_at(results.centroid, k);
  contact.centre = origin + vector_at(results.centre, k);
}

// Pairs that so many faces cut.
void collide_rims(const PairSlots& pairs, const SlabFaces& faces, const Slab& slab, std::size_t cut_count,
                  std::span<const RimPair> list, PairList& alone) {
  const Vec3 origin = origin_of(slab);
  RimTerms terms;
  terms.faces = &faces;
  terms.cut_count = cut_count;
  const auto gather = [&](const RimPair& pair, std::size_t k, RimTerms& to) {
    put_triangle(pairs.corners(pair.slot), origin, k, to);
    put_cuts(faces, pair.faces, k, to);
  };
  const auto give = [&](const RimPair& pair, std::size_t k, const RimTerms& from) {
    if (from.status[k] == kSlabUnclear) alone.push_back(pair.slot);
    if (from.status[k] == kSlabTouched)
      read_contact(from, k, slab, pairs.corners(pair.slot), pairs.contact[pair.slot]);
  };
  through_lanes(list, terms, pairs.kernels.slab_rims, gather, give);
}

}  // namespace

void collide_slab_pairs(const PairSlots& pairs, const Slab& slab, std::span<const std::uint32_t> list,
                        PairList& alone) {
  const Vec3 origin = origin_of(slab);
  FixedList<RimPair, kMostPairs> rims;
  SlabTerms terms;
  terms.faces = faces_of(slab);
  const auto gather = [&](std::uint32_t slot, std::size_t k, SlabTerms& to) {
    put_triangle(pairs.corners(slot), origin, k, to);
  };
  const auto give = [&](std::uint32_t slot, std::size_t k, const SlabTerms& from) {
    if (from.status[k] == kSlabTouched) read_contact(from, k, slab, pairs.corners(slot), pairs.contact[slot]);
    if (from.status[k] == kSlabUnclear) alone.push_back(slot);
    if (from.status[k] != kSlabCut) return;
    const RimPair pair{slot, static_cast<std::uint32_t>(from.cut[k])};
    if (cut_count(pair) > RimTerms::kMostCuts) {
      alone.push_back(slot);
    } else {
      rims.push_back(pair);
    }
  };
  through_lanes(list, terms, pairs.kernels.slab_contacts, gather, give);

  // Pairs with as many cuts share registers.
  FixedList<RimPair, kMostPairs> alike;
  for (std::size_t cuts = 0; cuts <= RimTerms::kMostCuts; ++cuts) {
    alike.clear();
    for (const RimPair& pair : rims) {
      if (cut_count(pair) == cuts) alike.push_back(pair);
    }
    collide_rims(pairs, terms.faces, slab, cuts, alike, alone);
  }
}

}  // namespace lumbrical
