//! Arrays as appended bytes.

use bytemuck::NoUninit;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;
use std::borrow::Cow;
use std::io::{self, Write};

/// Bytes that zlib compresses at a time. VTK's own default is 2¹⁵; larger blocks compress better and read as well.
const BLOCK: usize = 1 << 18;

/// How the bytes of the arrays are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compression {
    /// As they are: fastest.
    #[default]
    Raw,
    /// zlib at its fastest level: about two thirds of the size, several times the time.
    Zlib,
}

/// One array of the appended data, encoded.
pub(super) struct Array<'a> {
    /// Type and name as attributes.
    pub attributes: String,
    header: Vec<u8>,
    data: Cow<'a, [u8]>,
}

/// Types of VTK.
pub(super) trait Scalar: NoUninit {
    const NAME: &'static str;
}

impl Scalar for f64 {
    const NAME: &'static str = "Float64";
}

impl Scalar for u32 {
    const NAME: &'static str = "UInt32";
}

impl Scalar for i32 {
    const NAME: &'static str = "Int32";
}

impl<'a> Array<'a> {
    pub fn new<T: Scalar>(
        name: &str,
        components: usize,
        values: &'a [T],
        compression: Compression,
    ) -> io::Result<Array<'a>> {
        let attributes = format!(r#"type="{}" Name="{name}" NumberOfComponents="{components}""#, T::NAME);
        let data = little_endian(values);
        match compression {
            Compression::Raw => {
                Ok(Array { attributes, header: (data.len() as u64).to_le_bytes().to_vec(), data })
            }
            Compression::Zlib => compress(attributes, &data),
        }
    }

    /// Number of bytes in the file.
    pub fn len(&self) -> usize {
        self.header.len() + self.data.len()
    }

    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        out.write_all(&self.header)?;
        out.write_all(&self.data)
    }
}

/// Number of blocks, size of a block, size of the last one if it is smaller (else 0), then the compressed sizes.
fn compress<'a>(attributes: String, data: &[u8]) -> io::Result<Array<'a>> {
    let one = |block: &[u8]| {
        let mut encoder = ZlibEncoder::new(Vec::with_capacity(block.len()), flate2::Compression::fast());
        encoder.write_all(block)?;
        encoder.finish()
    };
    // Blocks are independent, and come back in their order.
    let blocks: Vec<Vec<u8>> = data.par_chunks(BLOCK).map(one).collect::<io::Result<_>>()?;
    let shape = [blocks.len() as u64, BLOCK as u64, (data.len() % BLOCK) as u64];
    let sizes = shape.into_iter().chain(blocks.iter().map(|block| block.len() as u64));
    let header = sizes.flat_map(u64::to_le_bytes).collect();
    Ok(Array { attributes, header, data: blocks.concat().into() })
}

fn little_endian<T: Scalar>(values: &[T]) -> Cow<'_, [u8]> {
    let bytes = bytemuck::cast_slice(values);
    if cfg!(target_endian = "little") {
        return bytes.into();
    }
    bytes.chunks_exact(size_of::<T>()).flat_map(|value| value.iter().rev().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use proptest::prelude::*;
    use std::io::Read;

    fn encode(values: &[u32], compression: Compression) -> Vec<u8> {
        let mut bytes = Vec::new();
        let array = Array::new("a", 1, values, compression).unwrap();
        array.write(&mut bytes).unwrap();
        assert_eq!(bytes.len(), array.len());
        bytes
    }

    fn word(bytes: &[u8], index: usize) -> usize {
        u64::from_le_bytes(bytes[8 * index..8 * index + 8].try_into().unwrap()) as usize
    }

    #[test]
    fn raw_bytes_follow_their_number() {
        assert_eq!(encode(&[1, 0x0203], Compression::Raw), [8, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 3, 2, 0, 0]);
        assert_eq!(encode(&[], Compression::Raw), [0; 8]);
        // No blocks at all.
        assert_eq!(word(&encode(&[], Compression::Zlib), 0), 0);
    }

    proptest! {
        /// The layout that `vtkXMLDataReader` expects, read by its description.
        #[test]
        fn blocks_add_up(count in 0usize..200_000, seed: u32) {
            let values: Vec<u32> = (0..count as u32).map(|i| i.wrapping_mul(seed)).collect();
            let bytes = encode(&values, Compression::Zlib);
            let (blocks, size, last) = (word(&bytes, 0), word(&bytes, 1), word(&bytes, 2));
            let mut at = 8 * (3 + blocks);
            let mut read = Vec::new();
            for block in 0..blocks {
                let stored = word(&bytes, 3 + block);
                let before = read.len();
                ZlibDecoder::new(&bytes[at..at + stored]).read_to_end(&mut read).unwrap();
                let full = if block + 1 == blocks && last > 0 { last } else { size };
                prop_assert_eq!(read.len() - before, full);
                at += stored;
            }
            prop_assert_eq!(at, bytes.len());
            prop_assert_eq!(read, values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>());
        }
    }
}
