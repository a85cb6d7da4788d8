//! Addresses of documents and paths of files.

use std::path::{Path, PathBuf};

use flank::ShippedFiles;

/// The scheme of documents of the shipped library.
pub(super) const LIBRARY: &str = "flank-library";
/// The scheme of pages about error codes.
pub(super) const ERRORS: &str = "flank-error";

/// The path behind an address. What is no file has a path that no system has.
pub(super) fn path(uri: &str) -> PathBuf {
    let Some((scheme, rest)) = uri.split_once(':') else { return PathBuf::from(decoded(uri)) };
    let rest = rest.strip_prefix("//").unwrap_or(rest);
    match scheme {
        "file" => {
            let path = decoded(rest);
            // `/c:/folder` of Windows
            let has_drive = cfg!(windows) && path.as_bytes().get(2) == Some(&b':');
            PathBuf::from(if has_drive { &path[1..] } else { &path })
        }
        LIBRARY => ShippedFiles::path(&decoded(rest)),
        _ => PathBuf::from(format!("/{scheme}:/{}", decoded(rest).trim_start_matches('/'))),
    }
}

/// The address of a path.
pub(super) fn of_path(path: &Path) -> String {
    if let Some(inside) = ShippedFiles::inside(path) {
        return format!("{LIBRARY}:/{}", encoded(&shown(inside)));
    }
    let shown = shown(path);
    let first = shown.trim_start_matches('/').split('/').next().unwrap_or_default();
    match first.strip_suffix(':') {
        Some(scheme) if shown.starts_with('/') && scheme.len() > 1 => {
            format!("{scheme}:{}", encoded(shown[1..].strip_prefix(first).unwrap_or_default().trim_start_matches('/')))
        }
        _ => format!("file://{}{}", if shown.starts_with('/') { "" } else { "/" }, encoded(&shown)),
    }
}

fn shown(path: &Path) -> String {
    path.display().to_string().replace('\\', "/")
}

fn encoded(path: &str) -> String {
    let mut out = String::new();
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"/-_.~!$&'()*+,;=:@".contains(&byte) {
            out.push(char::from(byte));
        } else {
            out += &format!("%{byte:02X}");
        }
    }
    out
}

/// Without percent signs; whatever is no UTF-8 then is U+FFFD.
pub(super) fn decoded(text: &str) -> String {
    let bytes = text.as_bytes();
    let digit = |at: usize| bytes.get(at).and_then(|byte| char::from(*byte).to_digit(16));
    let (mut out, mut at) = (Vec::new(), 0);
    while at < bytes.len() {
        match (bytes[at], digit(at + 1), digit(at + 2)) {
            (b'%', Some(high), Some(low)) => {
                out.push((16 * high + low) as u8);
                at += 3;
            }
            (byte, ..) => {
                out.push(byte);
                at += 1;
            }
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_lead_to_paths_and_back() {
        for (uri, expected) in [
            ("file:///a/b%20c.chain", "/a/b c.chain"),
            ("file:///a/%CE%A9.chain", "/a/Ω.chain"),
            ("flank-library:/bevel/pinion.chain", "/flank-library:/bevel/pinion.chain"),
            ("untitled:Untitled-1", "/untitled:/Untitled-1"),
        ] {
            assert_eq!(path(uri), PathBuf::from(expected));
            assert_eq!(of_path(Path::new(expected)), uri);
        }
        assert_eq!(path("file:///a/%zz%4"), PathBuf::from("/a/%zz%4"));
    }
}
