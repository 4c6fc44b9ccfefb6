//! Tables for moving the lanes of a mask to the front, which AVX2 has no instruction for.

use super::LANES;

/// For each mask of eight bits the numbers of its set bits, ascending; the rest are zero.
pub static LEFT: [[u8; LANES]; 256] = left();

/// `UNDER_XOR[x][mask]` has bit `i ^ x` set where `mask` has bit `i` set.
pub static UNDER_XOR: [[u8; 256]; LANES] = under_xor();

const fn left() -> [[u8; LANES]; 256] {
    let mut table = [[0; LANES]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut bit, mut at) = (0, 0);
        while bit < LANES {
            if mask >> bit & 1 == 1 {
                table[mask][at] = bit as u8;
                at += 1;
            }
            bit += 1;
        }
        mask += 1;
    }
    table
}

const fn under_xor() -> [[u8; 256]; LANES] {
    let mut table = [[0; 256]; LANES];
    let mut x = 0;
    while x < LANES {
        let mut mask = 0;
        while mask < 256 {
            let mut bit = 0;
            while bit < LANES {
                if mask >> bit & 1 == 1 {
                    table[x][mask] |= 1 << (bit ^ x);
                }
                bit += 1;
            }
            mask += 1;
        }
        x += 1;
    }
    table
}
