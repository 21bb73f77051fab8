//! Random Per Island: a number for each part of a mesh whose edges hang together, that of Cycles.

use super::random;

/// For each of `points` points the number, 0 to 1, of the island that it is part of; `edges` are pairs of points. Edges of
/// points that are not there are left out.
pub fn random_per_island(points: usize, edges: &[i32]) -> Vec<f32> {
    let mut sets = DisjointSets { parents: (0..points).collect(), ranks: vec![0; points] };
    for edge in edges.chunks_exact(2) {
        let [a, b] = [edge[0], edge[1]].map(|point| usize::try_from(point).ok().filter(|&point| point < points));
        if let (Some(a), Some(b)) = (a, b) {
            sets.join(a, b);
        }
    }
    (0..points).map(|point| random::of_number(sets.root(point) as u32)).collect()
}

/// Union by rank: which point stands for a set is part of the number.
struct DisjointSets {
    parents: Vec<usize>,
    ranks: Vec<u8>,
}

impl DisjointSets {
    fn root(&mut self, mut x: usize) -> usize {
        let mut root = x;
        while self.parents[root] != root {
            root = self.parents[root];
        }
        while self.parents[x] != root {
            (x, self.parents[x]) = (self.parents[x], root);
        }
        root
    }

    fn join(&mut self, x: usize, y: usize) {
        let (x, y) = (self.root(x), self.root(y));
        if x == y {
            return;
        }
        let (above, below) = if self.ranks[x] < self.ranks[y] { (y, x) } else { (x, y) };
        self.parents[below] = above;
        if self.ranks[above] == self.ranks[below] {
            self.ranks[above] += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn islands_have_one_number_each() {
        let found = random_per_island(7, &[0, 1, 1, 2, 4, 5, 9, 0, -1, 3]);
        assert!(found[0] == found[1] && found[1] == found[2] && found[4] == found[5]);
        let mut each = [found[0], found[3], found[4], found[6]];
        assert!(each.iter().all(|x| (0.0..=1.0).contains(x)));
        each.sort_by(f32::total_cmp);
        assert!(each.windows(2).all(|pair| pair[0] != pair[1]), "{each:?}");
        assert!(random_per_island(0, &[]).is_empty());
    }
}
