//! ffmpeg's names of layouts.

/// Which planes a frame has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Planes {
    Grey,
    /// G, B, R.
    Gbr,
    /// Luma, and chroma of its size over these, across and down.
    Yuv(usize, usize),
}

/// What to do about a layout that is not read.
pub(super) fn unread(pix_fmt: &str) -> String {
    format!(
        "has frames in the layout `{pix_fmt}`; read are YUV (4:2:0, 4:2:2, 4:4:4, 4:4:0, 4:1:1), RGB \
         and grey of integer codes in 8 to 16 bits. Convert it: ffmpeg -i FILM -c:v ffv1 -pix_fmt \
         gbrp16le FILM.mkv"
    )
}

/// Layouts whose codes are not in planes, and planes of the same codes. (ffmpeg deals them out
/// without arithmetic: tests/films.rs.)
const PACKED: [(&[&str], &str); 12] = [
    (&["rgb24", "bgr24", "rgb0", "bgr0", "0rgb", "0bgr"], "gbrp"),
    (&["rgba", "bgra", "argb", "abgr", "pal8"], "gbrp"),
    (&["rgb48", "bgr48", "rgba64", "bgra64"], "gbrp16le"),
    (&["ya8"], "gray"),
    (&["ya16"], "gray16le"),
    (&["nv12", "nv21"], "yuv420p"),
    (&["yuyv422", "uyvy422", "yvyu422", "nv16"], "yuv422p"),
    (&["nv24", "nv42"], "yuv444p"),
    (&["p010"], "yuv420p10le"),
    (&["p210", "y210", "nv20"], "yuv422p10le"),
    (&["p410"], "yuv444p10le"),
    (&["p016"], "yuv420p16le"),
];

/// Planes and bits of one of ffmpeg's layouts, and the layout to ask for.
pub(super) fn planes(pix_fmt: &str) -> Option<(Planes, u32, String)> {
    let plain = pix_fmt.strip_suffix("le").or(pix_fmt.strip_suffix("be")).unwrap_or(pix_fmt);
    let packed = PACKED.iter().find(|(names, _)| names.contains(&plain));
    let asked = match packed {
        Some((_, planes)) => (*planes).to_owned(),
        None if plain.len() < pix_fmt.len() => format!("{plain}le"),
        None => pix_fmt.to_owned(),
    };
    let name = asked.strip_suffix("le");
    let digits = |name: &str| name.bytes().rev().take_while(u8::is_ascii_digit).count().min(2);
    let (name, bits) = match name {
        Some(name) => {
            // `gray9`, but `yuv444p12`: a depth has one digit or two.
            let split = name.len() - digits(name);
            (&name[..split], name[split..].parse().ok().filter(|bits| (9..=16).contains(bits))?)
        }
        None => (asked.as_str(), 8),
    };
    let planes = match name {
        "gray" => Planes::Grey,
        "gbrp" | "gbrap" => Planes::Gbr,
        "yuv420p" | "yuvj420p" | "yuva420p" => Planes::Yuv(2, 2),
        "yuv422p" | "yuvj422p" | "yuva422p" => Planes::Yuv(2, 1),
        "yuv444p" | "yuvj444p" | "yuva444p" => Planes::Yuv(1, 1),
        "yuv440p" | "yuvj440p" => Planes::Yuv(1, 2),
        "yuv411p" | "yuvj411p" => Planes::Yuv(4, 1),
        "yuv410p" => Planes::Yuv(4, 4),
        _ => return None,
    };
    Some((planes, bits, asked))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_layouts_tell_planes_and_bits() {
        assert_eq!(planes("yuv420p").unwrap().1, 8);
        assert_eq!(planes("yuv422p10le").unwrap().0, Planes::Yuv(2, 1));
        assert_eq!(planes("gray9le").unwrap().1, 9);
        assert_eq!(planes("yuva444p12le").unwrap().1, 12);
        assert_eq!(planes("rgb24").unwrap().2, "gbrp");
        assert_eq!(planes("p010le").unwrap(), (Planes::Yuv(2, 2), 10, "yuv420p10le".into()));
        assert_eq!(planes("nv12").unwrap(), (Planes::Yuv(2, 2), 8, "yuv420p".into()));
        assert_eq!(planes("yuv420p10be").unwrap(), planes("yuv420p10le").unwrap());
        for unread in
            ["le", "be", "", "xyz12le", "gbrpf32le", "bayer_rggb16le", "rgb565le", "vaapi"]
        {
            assert_eq!(planes(unread), None, "{unread}");
        }
    }
}
