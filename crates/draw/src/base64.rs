//! Base64, which pages decode without loss.

const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Doubles, little-endian.
pub(crate) fn encoded(numbers: impl IntoIterator<Item = f64>) -> String {
    let bytes: Vec<u8> = numbers.into_iter().flat_map(f64::to_le_bytes).collect();
    encoded_bytes(&bytes)
}

/// Any bytes.
pub(crate) fn encoded_bytes(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let bits = (0..3).fold(0, |bits, k| bits << 8 | u32::from(three.get(k).copied().unwrap_or(0)));
        for k in 0..4 {
            let letter = if k <= three.len() { LETTERS[(bits >> (18 - 6 * k) & 63) as usize] } else { b'=' };
            text.push(char::from(letter));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bytes of 1.0 are six zeros, f0, 3f; those of two numbers leave one byte over, of three none.
    #[test]
    fn numbers_as_other_encoders_write_them() {
        assert_eq!(encoded([]), "");
        assert_eq!(encoded([1.0]), "AAAAAAAA8D8=");
        assert_eq!(encoded([1.0, -2.5]), "AAAAAAAA8D8AAAAAAAAEwA==");
        assert_eq!(encoded([0.1, 1.0, -2.5]), "mpmZmZmZuT8AAAAAAADwPwAAAAAAAATA");
    }
}
