// SPDX-License-Identifier: BSD-3-Clause
import {useEffect, useState} from 'preact/hooks';

/** Counts the changes between light and dark, by the button or by the system: what is drawn on a canvas is drawn again. */
export function useTheme(): number {
  const [changes, setChanges] = useState(0);
  useEffect(() => {
    const again = () => setChanges((before) => before + 1);
    const dark = matchMedia('(prefers-color-scheme: dark)');
    dark.addEventListener('change', again);
    document.addEventListener('themechange', again);
    return () => {
      dark.removeEventListener('change', again);
      document.removeEventListener('themechange', again);
    };
  }, []);
  return changes;
}
